#include "delegate/translate/normals.h"

#include <algorithm>
#include <optional>

#include "core/base/parallel.h"
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

// At the keys of `segments`, key-major.
std::vector<Vec3f> smooth_keys(const TriangleMesh& mesh, std::uint32_t segments) {
  std::vector<Vec3f> keys(std::size_t(key_count(segments)) * mesh.vertex_count);
  parallel_for(key_count(segments), [&](std::size_t key) {
    const std::vector<Vec3f> normals = normals_at(mesh, float(key_time(std::uint32_t(key), segments)));
    std::ranges::copy(normals, keys.begin() + std::ptrdiff_t(key * mesh.vertex_count));
  });
  return keys;
}

// Of linear keys from the mesh's own normals, at the middles between them.
double smooth_error(const TriangleMesh& mesh, const std::vector<Vec3f>& keys, std::uint32_t segments) {
  std::vector<double> worst(segments, 0.0);
  parallel_for(segments, [&](std::size_t s) {
    const std::vector<Vec3f> truth = normals_at(mesh, float((double(s) + 0.5) / segments));
    const Vec3f* a = keys.data() + s * mesh.vertex_count;
    for (std::size_t v = 0; v < truth.size(); ++v) {
      const Vec3d middle = Vec3d(a[v]) + Vec3d(a[v + mesh.vertex_count]);
      worst[s] = std::max(worst[s], length(Vec3d(truth[v]) - normalize(middle)));
    }
  });
  return *std::ranges::max_element(worst);
}

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

Primvar<Vec3f> smooth_normals(const TriangleMesh& mesh, std::uint32_t max_segments) {
  Primvar<Vec3f> normals;
  normals.interpolation = Interpolation::kVertex;
  normals.segments = mesh.segments;
  normals.values = smooth_keys(mesh, normals.segments);
  while (mesh.degree > 1 && normals.segments < max_segments &&
         smooth_error(mesh, normals.values, normals.segments) > kNormalTolerance) {
    normals.segments *= 2;
    normals.values = smooth_keys(mesh, normals.segments);
  }
  return normals;
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
