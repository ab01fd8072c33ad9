#include "delegate/translate/round/curve_normals.h"

#include <algorithm>
#include <utility>

#include "core/motion/track.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/normals.h"
#include "delegate/translate/rates.h"

namespace msbvh::translate {
namespace {

constexpr const char* kAttribute = "normals";
constexpr const char* kInstead = "; drawn turned to each ray";

// Directions: at least one that has a length, and none so long that products of it overflow.
bool check_directions(const ArraySamples& samples, PrimLog& log) {
  bool any = false;
  for (const ArraySample& sample : samples.samples) {
    for (const Vec3f& n : sample.values) {
      const Vec3f size = abs(n);
      const float largest = std::max({size.x, size.y, size.z});
      any |= largest > 0.0f;
      if (largest <= kMaxCoordinate) continue;
      log.warn(kAttribute, message("value ", &n - sample.values.data(), " is (", n.x, ", ", n.y, ", ", n.z,
                                   "); expected numbers of at most 2^60 in size", kInstead));
      return false;
    }
  }
  if (!any) log.warn(kAttribute, message("found 0 in all values; expected directions", kInstead));
  return any;
}

}  // namespace

std::optional<CurveNormals> CurveNormals::make(const MeshInput& input, const CurveBasis& curves,
                                               bool frame_only, PrimLog& log) {
  const auto has_values = [](const ArraySample& sample) { return !sample.values.empty(); };
  if (std::ranges::none_of(input.normals.samples, has_values)) return std::nullopt;
  ArraySamples samples = input.normals;
  if (!check_times(times_of(samples).times01, kAttribute, log)) return std::nullopt;
  const std::size_t base = base_sample(times_of(samples), input.time_remap.frame01);
  if (frame_only) samples.samples = {samples.samples[base]};
  if (!check_array(samples, kAttribute, log) || !check_directions(samples, log)) return std::nullopt;

  const std::string& token = input.normals_interpolation;
  const std::pair<Interpolation, std::size_t> expected =
      token == "constant"  ? std::pair{Interpolation::kConstant, std::size_t(1)}
      : token == "uniform" ? std::pair{Interpolation::kUniform, curves.curves}
      : token == "varying" || token == "faceVarying"
          ? std::pair{Interpolation::kVarying, curves.authored_varying}
          : std::pair{Interpolation::kVertex, curves.authored_vertices};
  const std::size_t count = samples.samples.front().values.size();
  const bool indexed = !input.normals_indices.empty();
  const std::size_t found = indexed ? input.normals_indices.size() : count;
  if (found != expected.second) {
    log.warn(kAttribute, message("found ", found, indexed ? " indices" : " values", "; expected ",
                                 expected.second, " for the interpolation ", token, kInstead));
    return std::nullopt;
  }
  std::vector<std::uint32_t> indices;
  for (const int index : input.normals_indices) {
    if (index < 0 || std::size_t(index) >= count) {
      log.warn(kAttribute, message("found the index ", index, "; expected 0 to ", count - 1, kInstead));
      return std::nullopt;
    }
    indices.push_back(std::uint32_t(index));
  }
  return CurveNormals(expected.first, samples, std::move(indices));
}

std::uint32_t CurveNormals::segments(const TransformTrack& transform, const TimeLayout& layout,
                                     std::uint32_t max_segments) const {
  return fit_normals({track_, transform}, layout, {kNormalTolerance, max_segments}).segments;
}

Vec3f CurveNormals::of_vertex(const Vec3f* values, std::size_t vertex, const CurveBasis& curves) const {
  const bool as_varying = interpolation_ == Interpolation::kVertex && curves.vertex_as_varying;
  const auto value = [&](std::size_t i) { return Vec3d(values[indices_.empty() ? i : indices_[i]]); };
  switch (as_varying ? Interpolation::kVarying : interpolation_) {
    case Interpolation::kConstant:
      return Vec3f(value(0));
    case Interpolation::kUniform:
      return Vec3f(value(curves.vertex_curves[vertex]));
    case Interpolation::kVarying: {
      const CurveBasis::Between& at = curves.varying[vertex];
      return Vec3f(lerp(value(at.from), value(at.to), at.w));
    }
    case Interpolation::kVertex:
      break;
  }
  Vec3d sum;
  for (const Term& term : curves.terms_of(vertex)) sum += value(term.index) * term.weight;
  return Vec3f(sum);
}

std::vector<Vec3f> CurveNormals::at_controls(const TransformTrack& transform, const TimeLayout& layout,
                                             std::uint32_t controls, const CurveBasis& curves) const {
  const std::vector<Vec3f> keys = normal_keys({track_, transform}, layout, controls - 1);
  std::vector<Vec3f> out;
  out.reserve(std::size_t(controls) * curves.vertex_count());
  for (std::uint32_t c = 0; c < controls; ++c) {
    const Vec3f* values = keys.data() + std::size_t(c) * track_.size();
    for (std::size_t v = 0; v < curves.vertex_count(); ++v) out.push_back(of_vertex(values, v, curves));
  }
  return out;
}

}  // namespace msbvh::translate
