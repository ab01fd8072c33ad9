#include "core/shade/world_triangle.h"

#include <algorithm>

#include "core/motion/affine_track.h"

namespace msbvh {
namespace {

// Error bounds count roundings of 2^-24; docs/design/watertight.md, section 4, derives them.
constexpr float kRounding = 0x1p-24f;
// Relative to the largest coordinate of the triangle's vertices: 1 for rounding the origin of a ray that
// leaves it, in the space that the tracer sees the triangle in.
constexpr float kPlaceError = 1 * kRounding;
// Likewise, at the controls around the time and for each degree of a moving mesh: 3 by which its
// interpolation here and in the tracer may part, where the tracer fuses the last two operations
// (core/base/lerp.h).
constexpr float kMotionError = 3 * kRounding;
// Relative to the triangle's extent on any axis, since the test works on differences to the ray's origin and
// its shear mixes the axes: 1 for the difference, 3 for the shear, 5 for the distance. Never 0, so that a ray
// does not start in the plane of a triangle that lies in a plane of coordinates.
constexpr float kTestError = 9 * kRounding;
// Relative to the sum of the sizes of the terms of a point's way out of an instance: 1 for rounding the
// origin in the world. The tracer inverts and applies the matrix in double precision: the way in adds
// nothing.
constexpr float kTransformError = 1 * kRounding;
// Likewise, for each degree of a moving instance: 3 as above, of its matrix.
constexpr float kTransformMotionError = 3 * kRounding;
// From a bound on each axis to one on the distance; rounded up for the bounds' own roundings.
constexpr float kRootOfThree = 1.7321f;

float largest(const Vec3f& v) { return std::max({v.x, v.y, v.z}); }

// In the mesh's own space.
template <EffectSet kEffects>
struct TrianglePose {
  Vec3f vertex[3];
  float size;  // the largest coordinate at the controls around the time

  TrianglePose(const TriangleMesh& shape, std::uint32_t triangle, float time) {
    if (!kEffects.has(Effect::kDeformingKeys) || shape.segments == 0) {
      const Triangle& t = shape.triangles[triangle];
      for (int corner = 0; corner < 3; ++corner) vertex[corner] = shape.positions[t[corner]];
      size = largest(max(max(abs(vertex[0]), abs(vertex[1])), abs(vertex[2])));
      return;
    }
    const SegmentTime at = locate(time, shape.segments);
    const Triangle& t = shape.triangles[triangle];
    const Vec3f* first = shape.control_positions(at.key * shape.degree);
    const std::uint32_t controls = shape.segments == 0 ? 1 : shape.degree + 1;
    Vec3f most;
    for (std::uint32_t c = 0; c < controls; ++c, first += shape.vertex_count) {
      for (const std::uint32_t v : t) most = max(most, abs(first[v]));
    }
    size = largest(most);
    for (int corner = 0; corner < 3; ++corner) vertex[corner] = shape.position(t[corner], time);
  }

  TrianglePose(const GridMesh& shape, const GridTriangle& triangle, float time) {
    const Grid& grid = shape.grids[triangle.grid];
    const auto v = vertices_of(triangle);
    const std::uint32_t first = locate(time, shape.segments).key * shape.degree;
    const std::uint32_t last = first + (shape.segments == 0 ? 0 : shape.degree);
    Vec3f most;
    for (int corner = 0; corner < 3; ++corner) {
      for (std::uint32_t c = first; c <= last; ++c)
        most = max(most, abs(shape.control_point(grid, v[corner].row, v[corner].column, c)));
      vertex[corner] = shape.point(grid, v[corner].row, v[corner].column, time);
    }
    size = largest(most);
  }

  // On each axis.
  float margin(const TrackForm& form) const {
    const Vec3f &a = vertex[0], &b = vertex[1], &c = vertex[2];
    const Vec3f extent = max(max(a, b), c) - min(min(a, b), c);
    const bool moves = kEffects.has(Effect::kDeformingKeys) && form.moving();
    const float place = kPlaceError + (moves ? kMotionError * float(form.degree) : 0.0f);
    return size * place + largest(extent) * kTestError;
  }
};

}  // namespace

InstancePose::InstancePose(const HitSource& source, float shutter_time) {
  const float time = source.instance_time(shutter_time);
  const TrackForm form = source.instances->form();
  const std::span<const Affine3f> controls = source.instance_controls();
  world_from_object = Affine3d(evaluate(controls, form, time));
  error = kTransformError + (form.moving() ? kTransformMotionError * float(form.degree) : 0.0f);
  const std::uint32_t first = locate(time, form.segments).key * form.degree;
  for (std::uint32_t c = first; c <= first + (form.moving() ? form.degree : 0); ++c) {
    reach = max(reach, abs(controls[c].x) + abs(controls[c].y) + abs(controls[c].z));
    place = max(place, abs(controls[c].t));
  }
}

template <EffectSet kEffects>
WorldTriangle world_triangle(const HitSource& source, const std::optional<InstancePose>& pose,
                             std::uint32_t triangle, float shutter_time) {
  using Pose = TrianglePose<kEffects>;
  constexpr bool kGrids = kEffects.has(Effect::kDisplacement);
  const float time = source.own_time<kEffects>(shutter_time);
  const bool is_mesh = !kGrids || source.mesh;
  const Pose own = is_mesh ? Pose(source.mesh->shape, triangle, time)
                           : Pose(source.grids->shape, source.grids->shape.triangle(triangle), time);
  const float margin = own.margin(is_mesh ? source.mesh->shape.form() : source.grids->shape.form());
  const Vec3d a(own.vertex[0]), b(own.vertex[1]), c(own.vertex[2]);
  if (!kEffects.has(Effect::kInstances) || !pose) return {{a, b, c}, margin * kRootOfThree};
  const Affine3d& m = pose->world_from_object;
  const Vec3f in_world = pose->reach * (margin + own.size * pose->error) + pose->place * pose->error;
  return {{m.point(a), m.point(b), m.point(c)}, largest(in_world) * kRootOfThree};
}

template WorldTriangle world_triangle<kPlain>(const HitSource&, const std::optional<InstancePose>&,
                                              std::uint32_t, float);
template WorldTriangle world_triangle<kKnownEffects>(const HitSource&, const std::optional<InstancePose>&,
                                                     std::uint32_t, float);

}  // namespace msbvh
