#include "delegate/translate/normals.h"

#include <algorithm>
#include <optional>

#include "core/base/parallel.h"
#include "core/motion/bezier.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/primvars.h"
#include "delegate/translate/rates.h"

namespace msbvh::translate {
namespace {

constexpr const char* kAttribute = "normals";

std::vector<Vec3f> normals_at(const TriangleMesh& mesh, float time) {
  std::vector<Vec3d> positions, sums(mesh.vertex_count);
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) positions.push_back(Vec3d(mesh.position(v, time)));
  for (const Triangle& t : mesh.triangles) {
    const Vec3d& a = positions[t[0]];
    const Vec3d twice_area = cross(positions[t[1]] - a, positions[t[2]] - a);
    for (const std::uint32_t vertex : t) sums[vertex] += twice_area;
  }
  std::vector<Vec3f> normals;
  for (const Vec3d& sum : sums) normals.push_back(Vec3f(normalize(sum)));
  return normals;
}

// `normals_at(time)`: those of a surface that moves in one way, `count` of them.
template <typename NormalsAt>
class NormalTrack {
 public:
  NormalTrack(std::size_t count, std::size_t most, const NormalsAt& normals_at)
      : count_(count), most_(most), normals_at_(normals_at) {}

  // A linear track takes its own keys, a curved one as many as follow to kNormalTolerance and can be
  // afforded.
  Primvar<Vec3f> fitted(const TrackForm& form, Interpolation interpolation, std::uint32_t max_segments,
                        PrimLog& log) const {
    Primvar<Vec3f> normals{interpolation, form.segments, keys(form.segments)};
    while (form.degree > 1 && normals.segments < max_segments &&
           error(normals.values, normals.segments) > kNormalTolerance) {
      if (count_ > most_ / key_count(2 * normals.segments)) {
        log.warn(kAttribute,
                 message("at ", key_count(normals.segments), " keys stray from the surface's by more than ",
                         kNormalTolerance, " radians; expected fewer than ", most_,
                         " at all keys together; a larger --edge-length helps"));
        break;
      }
      normals.segments *= 2;
      normals.values = keys(normals.segments);
    }
    return normals;
  }

 private:
  // At the keys of `segments`, key-major.
  std::vector<Vec3f> keys(std::uint32_t segments) const {
    std::vector<Vec3f> result(std::size_t(key_count(segments)) * count_);
    parallel_for(key_count(segments), [&](std::size_t key) {
      const std::vector<Vec3f> normals = normals_at_(float(key_time(std::uint32_t(key), segments)));
      std::ranges::copy(normals, result.begin() + std::ptrdiff_t(key * count_));
    });
    return result;
  }

  // Of linear keys from the surface's own normals, at the middles between them.
  double error(const std::vector<Vec3f>& keys, std::uint32_t segments) const {
    std::vector<double> worst(segments, 0.0);
    parallel_for(segments, [&](std::size_t s) {
      const std::vector<Vec3f> truth = normals_at_(float((double(s) + 0.5) / segments));
      const Vec3f* a = keys.data() + s * count_;
      for (std::size_t v = 0; v < truth.size(); ++v) {
        const Vec3d middle = Vec3d(a[v]) + Vec3d(a[v + count_]);
        worst[s] = std::max(worst[s], length(Vec3d(truth[v]) - normalize(middle)));
      }
    });
    return *std::ranges::max_element(worst);
  }

  std::size_t count_, most_;
  const NormalsAt& normals_at_;
};

// One of the authored values for each element of the triangle mesh, at every key.
std::vector<Vec3f> gathered(const std::vector<Vec3f>& keys, std::size_t value_count,
                            const std::vector<std::uint32_t>& source) {
  std::vector<Vec3f> result;
  result.reserve(keys.size() / value_count * source.size());
  for (std::size_t start = 0; start < keys.size(); start += value_count) {
    for (const std::uint32_t element : source) result.push_back(keys[start + element]);
  }
  return result;
}

}  // namespace

Primvar<Vec3f> smooth_normals(const TriangleMesh& mesh, std::uint32_t max_segments, PrimLog& log,
                              std::size_t most_normals) {
  const auto at = [&](float time) { return normals_at(mesh, time); };
  return NormalTrack(mesh.vertex_count, most_normals, at)
      .fitted(mesh.form(), Interpolation::kVertex, max_segments, log);
}

Primvar<Vec3f> limit_normals(const RefinedMesh& refined, const std::vector<Vec3f>& cage,
                             const TrackForm& form, std::uint32_t max_segments, PrimLog& log) {
  const std::size_t size = refined.cage().vertex_count;
  const auto at = [&](float time) {
    const SegmentTime place = locate(time, form.segments);
    const Vec3f* first = cage.data() + place.key * form.degree * size;
    if (!form.moving()) return refined.normals(first);
    std::vector<Vec3f> positions;
    for (std::size_t v = 0; v < size; ++v) {
      const auto control = [&](std::uint32_t c) { return Vec3d(first[c * size + v]); };
      positions.push_back(Vec3f(bezier(control, form.degree, double(place.w))));
    }
    return refined.normals(positions.data());
  };
  const bool creased = refined.has_creases();
  const std::size_t count = creased ? 3 * refined.triangles().size() : refined.point_count();
  const Interpolation interpolation = creased ? Interpolation::kFaceVarying : Interpolation::kVertex;
  return NormalTrack(count, kMostNormals, at).fitted(form, interpolation, max_segments, log);
}

Primvar<Vec3f> authored_normals(const MeshInput& input, const Triangulation& mesh, const NormalMotion& motion,
                                std::uint32_t max_segments, PrimLog& log) {
  const auto has_values = [](const ArraySample& sample) { return !sample.values.empty(); };
  if (std::ranges::none_of(input.normals.samples, has_values)) return {};
  PrimLog optional = log.of_optional_part();
  ArraySamples samples = input.normals;
  if (!check_times(times_of(samples).times01, kAttribute, optional)) return {};
  const std::size_t base = base_sample(times_of(samples), input.time_remap.frame01);
  const std::size_t count = samples.samples[base].values.size();
  if (motion.frame_only) samples.samples = {samples.samples[base]};
  if (!check_array(samples, kAttribute, optional)) return {};
  const std::optional<PrimvarMap> map =
      map_primvar(input.normals_interpolation, count, input.normals_indices, mesh, kAttribute, optional);
  if (!map) return {};

  const MovingArray normals{ArrayTrack(samples), motion.transform};
  const Fit fit = fit_normals(normals, motion.layout, {kNormalTolerance, max_segments});
  Primvar<Vec3f> result;
  result.interpolation = map->interpolation;
  result.segments = fit.segments;
  result.values = gathered(normal_keys(normals, motion.layout, fit.segments), count, map->source);
  return result;
}

}  // namespace msbvh::translate
