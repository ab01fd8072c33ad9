#include "delegate/translate/normals.h"

#include <algorithm>
#include <optional>

#include "core/base/parallel.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/primvars.h"

namespace msbvh::translate {
namespace {

constexpr const char* kAttribute = "normals";

void add_smooth_normals(const TriangleMesh& mesh, std::uint32_t key, Vec3f* normals) {
  const Vec3f* positions = mesh.control_positions(key);
  std::vector<Vec3d> sums(mesh.vertex_count);
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a(positions[t[0]]), b(positions[t[1]]), c(positions[t[2]]);
    const Vec3d twice_area = cross(b - a, c - a);
    for (const std::uint32_t vertex : t) sums[vertex] += twice_area;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) normals[i] = Vec3f(normalize(sums[i]));
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

Primvar<Vec3f> smooth_normals(const TriangleMesh& mesh) {
  Primvar<Vec3f> normals;
  normals.interpolation = Interpolation::kVertex;
  normals.segments = mesh.segments;
  normals.values.resize(mesh.position_count());
  parallel_for(key_count(mesh.segments), [&](std::size_t key) {
    add_smooth_normals(mesh, std::uint32_t(key), normals.values.data() + key * mesh.vertex_count);
  });
  return normals;
}

Primvar<Vec3f> authored_normals(const MeshInput& input, const Triangulation& mesh,
                                const TransformTrack& transform, std::uint32_t max_segments, PrimLog& log) {
  const auto has_values = [](const ArraySample& sample) { return !sample.values.empty(); };
  if (std::ranges::none_of(input.normals.samples, has_values)) return {};
  PrimLog optional = log.of_optional_part();
  if (!check_array(input.normals, kAttribute, optional)) return {};
  const std::size_t count = input.normals.samples.front().values.size();
  const std::optional<PrimvarMap> map =
      map_primvar(input.normals_interpolation, count, input.normals_indices, mesh, kAttribute, optional);
  if (!map) return {};

  const MovingArray normals{ArrayTrack(input.normals), transform};
  const Fit fit = fit_normals(normals, {kNormalTolerance, max_segments});
  Primvar<Vec3f> result;
  result.interpolation = map->interpolation;
  result.segments = fit.segments;
  result.values = gathered(normal_keys(normals, fit.segments), count, map->source);
  return result;
}

}  // namespace msbvh::translate
