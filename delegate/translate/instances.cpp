#include "delegate/translate/instances.h"

#include <algorithm>
#include <bit>

#include "core/base/parallel.h"
#include "core/motion/track.h"
#include "delegate/translate/transform_fit.h"

namespace msbvh::translate {
namespace {

constexpr const char* kMatrices = "instance transforms";
constexpr std::size_t kGrain = 1024;

// 0 still, else 1 + log2(segments).
constexpr std::size_t class_of(std::uint32_t segments) { return std::size_t(std::bit_width(segments)); }
constexpr std::uint32_t segments_of(std::size_t fit_class) {
  return fit_class == 0 ? 0 : 1u << (fit_class - 1);
}
constexpr std::size_t kClasses = class_of(kMaxSegments) + 1;

enum class Fate : std::uint8_t { kDrawn, kNotFinite, kFlat, kVanished };

struct Verdict {
  Fate fate = Fate::kDrawn;
  Fit fit;
};

// Two columns that are not parallel span a plane.
bool is_plane_at_least(const Affine3d& map) {
  return cross(map.x, map.y) != Vec3d{} || cross(map.y, map.z) != Vec3d{} || cross(map.z, map.x) != Vec3d{};
}

Fate fate_of(std::span<const Affine3d> maps) {
  if (!std::ranges::all_of(maps, is_representable)) return Fate::kNotFinite;
  if (!std::ranges::all_of(maps, is_singular)) return Fate::kDrawn;
  return std::ranges::any_of(maps, is_plane_at_least) ? Fate::kFlat : Fate::kVanished;
}

// The samples that the shutter sees of one instance after the other, rebased.
class InstanceReader {
 public:
  InstanceReader(const InstancesInput& input, const InstanceTarget& target)
      : input_(input),
        target_(target),
        range_(samples_of_shutter(input.times01)),
        count_(input.matrices.size() / input.times01.size()) {}

  std::size_t count() const { return count_; }
  std::span<const double> times01() const {
    return std::span(input_.times01).subspan(range_.first, range_.count());
  }
  void read(std::size_t instance, std::vector<Affine3d>& maps) const {
    maps.clear();
    for (std::size_t i = range_.first; i <= range_.last; ++i) {
      const Affine3d map = affine_from(input_.matrices[i * count_ + instance]);
      maps.push_back(rebased(map, target_.prototype_origin, target_.world_origin));
    }
  }

 private:
  const InstancesInput& input_;
  const InstanceTarget& target_;
  SampleRange range_;
  std::size_t count_;
};

std::vector<Verdict> judge(const InstanceReader& reader, const TransformFitter& fitter, const Box3d& box) {
  std::vector<Verdict> verdicts(reader.count());
  const BoxCorners corners = corners_of(box);
  parallel_for_ranges(reader.count(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Affine3d> maps;
    for (std::size_t i = begin; i < end; ++i) {
      reader.read(i, maps);
      verdicts[i].fate = fate_of(maps);
      if (verdicts[i].fate == Fate::kDrawn) verdicts[i].fit = fitter.fit(maps, corners);
    }
  });
  return verdicts;
}

void report_left_out(const std::vector<Verdict>& verdicts, Fate fate, const char* found, const char* expected,
                     PrimLog& log) {
  const auto is_such = [fate](const Verdict& verdict) { return verdict.fate == fate; };
  const auto count = std::ranges::count_if(verdicts, is_such);
  if (count == 0) return;
  const auto first = std::ranges::find_if(verdicts, is_such) - verdicts.begin();
  log.warn(kMatrices, message(count, " of ", verdicts.size(), " instances placed together (number ", first,
                              " is the first) ", found, "; expected ", expected, "; they are left out"));
}

TrackReport report_track(const std::vector<Verdict>& verdicts, const FitSettings& settings, PrimLog& log) {
  TrackReport track{log.path(), 0, true, 0.0};
  std::size_t beyond = 0;
  for (const Verdict& verdict : verdicts) {
    track.segments = std::max(track.segments, verdict.fit.segments);
    track.error_pixels = std::max(track.error_pixels, verdict.fit.error);
    beyond += verdict.fit.error > settings.tolerance;
  }
  track.moving_transform = track.segments > 0;
  if (beyond > 0) {
    log.warn(kMatrices, message("the motion of ", beyond, " of ", verdicts.size(),
                                " instances deviates by up to ", track.error_pixels, " pixels at ",
                                track.segments, " segments; expected at most ", settings.tolerance));
  }
  return track;
}

InstanceSet gather(const InstancesInput& input, const InstanceReader& reader, const TransformFitter& fitter,
                   std::uint32_t segments, const std::vector<std::size_t>& members) {
  const std::size_t keys = key_count(segments);
  InstanceSet set{input.path, input.prototype, segments, {}, {}};
  set.world_from_prototype.resize(members.size() * keys);
  if (!input.display_color.empty()) set.display_color.resize(members.size());
  parallel_for_ranges(members.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Affine3d> maps;
    for (std::size_t i = begin; i < end; ++i) {
      reader.read(members[i], maps);
      fitter.keys(maps, segments, set.world_from_prototype.data() + i * keys);
      if (!input.display_color.empty()) set.display_color[i] = input.display_color[members[i]];
    }
  });
  return set;
}

bool check(const InstancesInput& input, PrimLog& log) {
  if (!check_times(input.times01, kMatrices, log)) return false;
  if (input.matrices.size() % input.times01.size() == 0) return true;
  return log.reject(kMatrices, message("found ", input.matrices.size(), " matrices; expected a multiple of ",
                                       input.times01.size(), ", the number of times"));
}

// Without the colours, where they do not fit.
InstancesInput with_checked_colors(InstancesInput input, std::size_t count, PrimLog log) {
  const std::span<const Vec3f> colors = input.display_color;
  if (colors.empty()) return input;
  const bool finite = std::ranges::all_of(colors, [](const Vec3f& color) { return is_finite(color); });
  if (colors.size() == count && finite) return input;
  log.of_optional_part().reject(
      "primvars:displayColor", message("found ", colors.size(), finite ? "" : " not all finite",
                                       " values; expected ", count, ", one finite colour for each instance"));
  input.display_color = {};
  return input;
}

}  // namespace

TranslatedInstances translate_instances(const InstancesInput& given, const InstanceTarget& target,
                                        PrimLog& log) {
  if (!check(given, log)) return {};
  const std::size_t count = given.matrices.size() / given.times01.size();
  const InstancesInput input = with_checked_colors(given, count, log);
  const InstanceReader reader(input, target);
  const TransformFitter fitter(reader.times01(), target.measure, target.settings);
  const std::vector<Verdict> verdicts = judge(reader, fitter, target.box);
  report_left_out(verdicts, Fate::kNotFinite, "have a matrix that is not finite or too large",
                  "finite numbers of at most 2^60 in size", log);
  report_left_out(verdicts, Fate::kFlat, "are flattened to a plane", "an invertible matrix", log);

  TranslatedInstances result;
  result.track = report_track(verdicts, target.settings, log);
  std::array<std::vector<std::size_t>, kClasses> members;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    if (verdicts[i].fate == Fate::kDrawn) members[class_of(verdicts[i].fit.segments)].push_back(i);
  }
  for (std::size_t c = 0; c < kClasses; ++c) {
    if (!members[c].empty()) result.sets.push_back(gather(input, reader, fitter, segments_of(c), members[c]));
  }
  return result;
}

}  // namespace msbvh::translate
