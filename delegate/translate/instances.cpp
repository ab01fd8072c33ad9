#include "delegate/translate/instances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <ranges>
#include <tuple>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/stretch.h"
#include "delegate/translate/instance_chain.h"
#include "delegate/translate/outside_judge.h"
#include "delegate/translate/primvar_track.h"
#include "delegate/translate/primvars.h"
#include "delegate/translate/transform_fit.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

constexpr const char* kMatrices = "instance transforms";
constexpr std::size_t kGrain = 1024;

using Fate = TransformFitter::Fate;

std::vector<Judgement> judge_all(const OutsideJudge& judge, std::size_t count) {
  std::vector<Judgement> judgements(count);
  parallel_for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) judgements[i] = judge.judge(i);
  });
  return judgements;
}

bool is_drawn(const Judgement& judgement) { return judgement.verdict.fate == Fate::kDrawn; }

void report_left_out(const InstanceChain& chain, const std::vector<Judgement>& judgements, Fate fate,
                     const char* found, const char* expected, PrimLog& log) {
  const auto is_such = [fate](const Judgement& judgement) { return judgement.verdict.fate == fate; };
  const auto count = std::ranges::count_if(judgements, is_such);
  if (count == 0) return;
  const auto first = std::ranges::find_if(judgements, is_such) - judgements.begin();
  if (const auto blame = fate == Fate::kNotFinite ? chain.blame(std::size_t(first)) : std::nullopt) {
    log.of_prim(blame->path)
        .warn(blame->attribute, message(blame->found, "; expected ", expected, "; ", count, " of ",
                                        judgements.size(), " instances placed together are left out"));
    return;
  }
  log.warn(kMatrices, message(count, " of ", judgements.size(), " instances placed together (number ", first,
                              " is the first) ", found, "; expected ", expected, "; they are left out"));
}

// Those that miss their tolerance, which is the same of all.
struct Beyond {
  std::size_t count = 0;
  Judgement worst;

  void add(const Judgement& judgement) {
    if (count++ == 0 || judgement.verdict.error > worst.verdict.error) worst = judgement;
  }
};

// What instances have in common in a report: the costliest track, sums, and the error that counts most.
class Common {
 public:
  void add(const Judgement& judgement, const TransformFitter& fitter) {
    costliest_ = std::max(costliest_, judgement.verdict.track);  // tracks are in the order of what they cost
    report_.bytes += fitter.form(judgement.verdict.track).controls() * sizeof(Affine3f);
    report_.outside += judgement.outside;
    report_.coarser += judgement.keys_saved > 0;
    report_.keys_saved += judgement.keys_saved;
    if (!has_error_ || weight(worst_) < weight(judgement)) worst_ = judgement;
    has_error_ = true;
    if (judgement.is_beyond()) beyond_[judgement.outside].add(judgement);
  }

  TrackReport report(const TransformFitter& fitter, double tolerance) {
    report_.set_form(fitter.form(costliest_), fitter.time_remap(costliest_));
    report_.moving_transform = report_.segments > 0;
    report_.error_pixels = worst_.verdict.error;
    report_.tolerance_pixels = has_error_ ? worst_.tolerance : tolerance;
    report_.error_outside = worst_.outside;
    return report_;
  }

  const Beyond& beyond(bool outside) const { return beyond_[outside]; }

 private:
  // What is seen counts before what is not, and what misses its tolerance before either.
  static std::tuple<bool, bool, double> weight(const Judgement& judgement) {
    return {judgement.is_beyond(), !judgement.outside, judgement.verdict.error / judgement.tolerance};
  }

  TrackReport report_;
  std::uint32_t costliest_ = 0;
  bool has_error_ = false;
  Judgement worst_;
  std::array<Beyond, 2> beyond_;  // of what is seen, and of what is outside of the picture
};

TrackReport report_track(const std::vector<Judgement>& judgements, const InstanceChain& chain,
                         const TransformFitter& fitter, const FitSettings& settings, PrimLog& log) {
  Common common;
  for (const Judgement& judgement : judgements) {
    if (is_drawn(judgement)) common.add(judgement, fitter);
  }
  TrackReport report = common.report(fitter, settings.tolerance);
  report.path = log.path();
  report.source = "instances";
  report.rule = chain.rule();
  report.count = judgements.size();
  for (const bool outside : {false, true}) {
    const auto& [beyond, worst] = common.beyond(outside);
    if (beyond == 0) continue;
    log.warn(kMatrices,
             message("the motion of ", beyond, " of ", judgements.size(), " instances",
                     outside ? " outside of the picture" : "", " deviates by up to ", worst.verdict.error,
                     " pixels at ", fitter.form(worst.verdict.track).segments, " segments; expected at most ",
                     worst.tolerance, "; ", advice(settings.choice)));
  }
  return report;
}

// Each prim for itself, over all places where the outer levels put it.
std::vector<TrackReport> report_prims(const InstancesInput& input, const std::vector<Judgement>& judgements,
                                      const InstanceChain& chain, const TransformFitter& fitter,
                                      FitSettings settings, PrimLog& log) {
  std::vector<Common> common(input.paths.size());
  for (std::size_t i = 0; i < judgements.size(); ++i) {
    if (is_drawn(judgements[i])) common[i % common.size()].add(judgements[i], fitter);
  }
  std::vector<TrackReport> reports;
  const std::string rule = chain.rule();
  const double tolerance = settings.tolerance;
  for (std::size_t prim = 0; prim < common.size(); ++prim) {
    reports.push_back(common[prim].report(fitter, tolerance));
    TrackReport& report = reports.back();
    report.path = input.paths[prim];
    report.source = report.moving_transform ? "transform" : "points";
    report.rule = report.moving_transform ? rule : "still";
    report.count = judgements.size() / common.size();
    PrimLog own = log.of_part(report.path);
    for (const bool outside : {false, true}) {
      const auto& [beyond, worst] = common[prim].beyond(outside);
      if (beyond == 0) continue;
      settings.tolerance = worst.tolerance;
      report_fit({fitter.form(worst.verdict.track).segments, worst.verdict.error}, settings, "xformOpOrder",
                 outside ? "the motion outside of the picture" : "the motion", own);
    }
  }
  return reports;
}

// Of some instances; empty where their places in the set say the same.
std::vector<std::int32_t> instance_ids(std::span<const std::int32_t> given,
                                       const std::vector<std::size_t>& members) {
  std::vector<std::int32_t> ids;
  bool counted = true;
  for (const std::size_t member : members) {
    const auto id = given.empty() ? static_cast<std::int32_t>(member) : given[member];
    counted = counted && id == static_cast<std::int32_t>(ids.size());
    ids.push_back(id);
  }
  return counted ? std::vector<std::int32_t>{} : ids;
}

// Of all instances, beside reports of each of their prims: a count of places, and what those have counted is
// not counted again.
void make_whole(TrackReport& report, std::size_t prims) {
  report.count /= prims;
  report.outside = report.coarser = report.keys_saved = 0;
}

// Of the members of a set: each prim's, or those of the one report.
std::vector<Saving> savings_of(const std::vector<std::size_t>& members,
                               const std::vector<Judgement>& judgements, std::size_t prims) {
  std::map<std::size_t, Saving> found;
  for (const std::size_t i : members) {
    if (judgements[i].keys_saved == 0) continue;
    const std::size_t report = prims == 0 ? 0 : i % prims;
    Saving& saving = found[report];
    saving.report = report;
    ++saving.coarser;
    saving.keys_saved += judgements[i].keys_saved;
  }
  const auto savings = std::views::values(found);
  return {savings.begin(), savings.end()};
}

// What an input says of all `count` instances, as far as it fits.
struct OfInstances {
  std::size_t count = 0;
  PrimvarTrack<Vec3f> colors{};
  std::span<const float> opacities{};
  std::vector<std::pair<PrimvarName, std::span<const Vec3f>>> primvars{};  // by increasing names
};

void add_values(const OfInstances& all, const std::vector<std::size_t>& members, InstanceSet& set) {
  for (const std::size_t member : all.opacities.empty() ? std::vector<std::size_t>{} : members)
    set.display_opacity.push_back(all.opacities[member]);
  for (const auto& [name, values] : all.primvars) {
    InstancePrimvar& primvar = set.primvars.emplace_back(InstancePrimvar{name, {}});
    for (const std::size_t member : members) primvar.values.push_back(values[member]);
  }
}

InstanceSet gather(const InstancesInput& input, const TransformFitter& fitter, std::uint32_t track,
                   const std::vector<std::size_t>& members, const OfInstances& all) {
  const PrimvarTrack<Vec3f>& colors = all.colors;
  const std::size_t count = all.count;
  const TrackForm form = fitter.form(track);
  InstanceSet set{input.path, input.prototype, form.segments, {}, {}, form.degree, fitter.time_remap(track)};
  if (input.visible) set.time_remap = with_visibility(set.time_remap, *input.visible);
  set.world_from_prototype.resize(members.size() * form.controls());
  set.ids = instance_ids(input.ids, members);
  add_values(all, members, set);
  const bool colored = !colors.values.empty();
  set.color_segments = colors.segments;
  if (colored) set.display_color.resize(members.size() * key_count(colors.segments));
  if (!input.materials.empty()) set.materials.resize(members.size());
  parallel_for_ranges(members.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      fitter.controls(members[i], track, set.world_from_prototype.data() + i * form.controls());
      for (std::size_t key = 0; colored && key < key_count(colors.segments); ++key) {
        set.display_color[key * members.size() + i] = colors.values[key * count + members[i]];
      }
      if (!input.materials.empty()) {
        const int material = input.materials[members[i]];
        set.materials[i] = material < 0 ? kNone : std::uint32_t(material);
      }
    }
  });
  return set;
}

bool has_fitting_sizes(const InstancesInput& input, std::size_t count, std::uint32_t material_count,
                       PrimLog& log) {
  if (!input.paths.empty() && count % input.paths.size() != 0) {
    return log.reject("paths", message("found ", input.paths.size(), " for ", count,
                                       " instances; expected one for each of the innermost level"));
  }
  if (!input.ids.empty() && input.ids.size() != count) {
    return log.reject("ids", message("found ", input.ids.size(), "; expected ", count, ", one an instance"));
  }
  if (input.materials.empty()) return true;
  const int largest = *std::ranges::max_element(input.materials);
  if (input.materials.size() == count && largest < std::int64_t(material_count)) return true;
  return log.reject("material:binding",
                    message("found ", input.materials.size(), " materials, the largest ", largest,
                            "; expected ", count, " and less than ", material_count));
}

constexpr const char* kColor = "primvars:displayColor";

// Of `count` instances; none where they do not fit.
PrimvarTrack<Vec3f> color_track(const InstancesInput& input, std::size_t count, std::uint32_t max_segments,
                                PrimLog log) {
  const std::span<const Vec3f> colors = input.display_color.values;
  if (colors.empty()) return {};
  const bool finite = std::ranges::all_of(colors, [](const Vec3f& color) { return is_color(color); });
  if (colors.size() == count && finite) return fit_primvar(input.display_color, max_segments, kColor, log);
  log.of_optional_part().reject(
      kColor, message("found ", colors.size(), finite ? "" : " not all finite and of at most 65504",
                      " values; expected ", count, ", one finite colour for each instance"));
  return {};
}

// Whether there is one good value for each of `count` instances.
template <typename T>
bool check_values(std::span<const T> values, std::size_t count, const std::string& attribute, PrimLog log) {
  const bool finite = std::ranges::all_of(values, [](const T& value) { return is_color(value); });
  if (values.size() == count && finite) return true;
  return log.of_optional_part().reject(
      attribute, message("found ", values.size(), finite ? "" : " not all finite and of at most 65504",
                         " values; expected ", count, ", one finite value for each instance"));
}

OfInstances of_instances(const InstancesInput& input, std::size_t count, const InstanceTarget& target,
                         PrimLog& log) {
  OfInstances all{count, color_track(input, count, target.settings.max_segments, log)};
  const std::span<const float> opacities = input.display_opacity;
  if (!opacities.empty() && check_values(opacities, count, "primvars:displayOpacity", log))
    all.opacities = opacities;
  for (const NamedPrimvar& named : input.primvars) {
    const PrimvarName name = target.materials ? target.materials->find(named.name) : kNoPrimvar;
    if (name == kNoPrimvar || named.primvar.values.empty()) continue;
    if (check_values(named.primvar.values, count, full_name(named), log))
      all.primvars.emplace_back(name, named.primvar.values);
  }
  std::ranges::sort(all.primvars, {}, [](const auto& each) { return each.first; });
  return all;
}

// When instances are looked at for how large they are seen: a few of the dense times, spread so that no
// period meets them all.
std::vector<double> times_of_size(const InstanceChain& chain) {
  constexpr std::size_t kMost = 64;
  if (chain.is_still()) return {0.5};
  std::vector<double> times01{0.0, 0.5, 1.0};
  const std::vector<double> dense01 = chain.dense_times01();
  for (std::size_t i = 0; i < std::min(dense01.size(), kMost); ++i) {
    const double place =
        dense01.size() <= kMost ? double(i) : std::fmod(i * std::numbers::phi, 1.0) * dense01.size();
    times01.push_back(dense01[std::size_t(place)]);
  }
  return times01;
}

}  // namespace

TranslatedInstances translate_instances(const InstancesInput& input, const InstanceTarget& target,
                                        PrimLog& log) {
  const std::optional<InstanceChain> chain = InstanceChain::make(input.levels, log);
  if (!chain || chain->count() == 0 ||
      !has_fitting_sizes(input, chain->count(), target.material_count, log)) {
    return {};
  }
  const OfInstances all = of_instances(input, chain->count(), target, log);
  const TransformFitter fitter(*chain, {target.prototype_origin, target.world_origin, target.box},
                               target.measure, target.settings);
  const OutsideJudge judge(fitter, target.settings, target.box, target.outside);
  const std::vector<Judgement> judgements = judge_all(judge, chain->count());
  report_left_out(*chain, judgements, Fate::kNotFinite, "have a matrix that is not finite or too large",
                  "finite numbers of at most 2^60 in size", log);
  report_left_out(*chain, judgements, Fate::kFlat, "are flattened to a plane", "an invertible matrix", log);

  TranslatedInstances result;
  const FitSettings& settings = target.settings;
  if (!input.paths.empty()) result.tracks = report_prims(input, judgements, *chain, fitter, settings, log);
  if (input.paths.empty() || input.report_whole) {
    result.tracks.push_back(report_track(judgements, *chain, fitter, settings, log));
    if (!input.paths.empty()) make_whole(result.tracks.back(), input.paths.size());
  }
  for (TrackReport& track : result.tracks) track.hidden_partly = input.visible.has_value();
  std::vector<std::vector<std::size_t>> members(fitter.track_count());
  for (std::size_t i = 0; i < judgements.size(); ++i) {
    if (is_drawn(judgements[i])) members[judgements[i].verdict.track].push_back(i);
  }
  for (std::uint32_t track = 0; track < members.size(); ++track) {
    if (members[track].empty()) continue;
    result.sets.push_back(gather(input, fitter, track, members[track], all));
    result.savings.push_back(savings_of(members[track], judgements, input.paths.size()));
  }
  return result;
}

double pixels_per_unit(const InstancesInput& input, const InstanceTarget& target) {
  std::vector<Diagnostic> unsaid;  // add_instances() will say it
  PrimLog log(unsaid, input.path);
  const std::optional<InstanceChain> chain = InstanceChain::make(input.levels, log);
  if (!chain || target.box.empty()) return 0.0;
  const BoxCorners corners = corners_of(target.box);
  std::vector<double> largest((chain->count() + kGrain - 1) / kGrain, 0.0);
  for (const double time01 : times_of_size(*chain)) {
    const InstanceChain::Instant instant = chain->at(time01, time01);
    const ScreenInstant screen = target.measure.at(time01);
    parallel_for_ranges(chain->count(), kGrain, [&](std::size_t begin, std::size_t end) {
      double& mine = largest[begin / kGrain];
      for (std::size_t i = begin; i < end; ++i) {
        const Affine3d map = rebased(instant.map(i), target.prototype_origin, target.world_origin);
        if (!is_representable(map)) continue;
        mine = std::max(mine, screen.in_box(largest_stretch(map), bounds_of(corners, map)));
      }
    });
  }
  return largest.empty() ? 0.0 : *std::ranges::max_element(largest);
}

}  // namespace msbvh::translate
