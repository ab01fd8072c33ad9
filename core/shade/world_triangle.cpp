#include "core/shade/world_triangle.h"

#include <algorithm>

#include "core/motion/affine_track.h"

namespace msbvh {
namespace {

// Error bounds count roundings of 2^-24; docs/design/watertight.md, section 4, derives them.
constexpr double kRounding = 0x1p-24;
// Relative to the largest coordinate, by axis, of the triangle's vertices: 1 for rounding the origin of a ray
// that leaves it, in the space that the tracer sees the triangle in.
constexpr double kPlaceError = 1 * kRounding;
// Likewise, at the controls around the time and for each degree of a moving mesh: 3 by which its interpolation here
// and in the tracer may part, where the tracer fuses the last two operations (core/base/lerp.h).
constexpr double kMotionError = 3 * kRounding;
// Relative to the triangle's extent on any axis, since the test works on differences to the ray's origin and
// its shear mixes the axes: 1 for the difference, 3 for the shear, 5 for the distance. Never 0, so that a ray
// does not start in the plane of a triangle that lies in a plane of coordinates.
constexpr double kTestError = 9 * kRounding;
// Relative to the sum of the sizes of the terms of a point's way out of an instance: 1 for rounding the origin in the
// world. The tracer inverts and applies the matrix in double precision: the way in adds nothing.
constexpr double kTransformError = 1 * kRounding;
// Likewise, for each degree of a moving instance: 3 as above, of its matrix.
constexpr double kTransformMotionError = 3 * kRounding;

Affine3d abs(const Affine3d& a) {
  return {msbvh::abs(a.x), msbvh::abs(a.y), msbvh::abs(a.z), msbvh::abs(a.t)};
}

// In the mesh's own space.
struct TrianglePose {
  Vec3d vertex[3];
  Vec3d size;  // by axis, the largest coordinate at the controls around the time

  TrianglePose(const TriangleMesh& shape, std::uint32_t triangle, float time) {
    const std::uint32_t first = locate(time, shape.segments).key * shape.degree;
    const std::uint32_t controls = shape.segments == 0 ? 1 : shape.degree + 1;
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = shape.triangles[triangle][corner];
      vertex[corner] = Vec3d(shape.position(v, time));
      for (std::uint32_t c = first; c < first + controls; ++c) {
        size = max(size, Vec3d(msbvh::abs(shape.control_positions(c)[v])));
      }
    }
  }

  Vec3d margin(const TrackForm& form) const {
    const Vec3d extent =
        max(max(vertex[0], vertex[1]), vertex[2]) - min(min(vertex[0], vertex[1]), vertex[2]);
    const double test = kTestError * std::max({extent.x, extent.y, extent.z});
    const double place = kPlaceError + (form.moving() ? kMotionError * form.degree : 0.0);
    return size * place + Vec3d{test, test, test};
  }
};

}  // namespace

ObjectPose::ObjectPose(const HitSource& source, float shutter_time) : instanced(source.instances != nullptr) {
  if (!instanced) return;
  const float time = source.instance_time(shutter_time);
  const TrackForm form = source.instances->form();
  const std::span<const Affine3f> controls = source.instance_controls();
  world_from_object = Affine3d(evaluate(controls, form, time));
  error = kTransformError + (form.moving() ? kTransformMotionError * form.degree : 0.0);
  const std::uint32_t first = locate(time, form.segments).key * form.degree;
  size = abs(Affine3d(controls[first]));
  for (std::uint32_t c = first + 1; form.moving() && c <= first + form.degree; ++c) {
    const Affine3d m = abs(Affine3d(controls[c]));
    size = {max(size.x, m.x), max(size.y, m.y), max(size.z, m.z), max(size.t, m.t)};
  }
}

WorldTriangle world_triangle(const HitSource& source, const ObjectPose& pose, std::uint32_t triangle,
                             float shutter_time) {
  const TriangleMesh& shape = source.mesh->shape;
  const TrianglePose own(shape, triangle, source.mesh_time(shutter_time));
  const Vec3d margin = own.margin(shape.form());
  if (!pose.instanced) return {{own.vertex[0], own.vertex[1], own.vertex[2]}, margin};
  const Affine3d& m = pose.world_from_object;
  return {{m.point(own.vertex[0]), m.point(own.vertex[1]), m.point(own.vertex[2])},
          pose.size.vector(margin + own.size * pose.error) + pose.size.t * pose.error};
}

}  // namespace msbvh
