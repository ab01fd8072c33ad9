#include "core/shade/surface.h"

#include <algorithm>

#include "core/motion/affine_track.h"
#include "core/scene/opacity.h"
#include "core/shade/primvar.h"

namespace msbvh {
namespace {

// Error bounds count roundings of 2^-24 and are rounded up to a power of two.
//
// Relative to the largest coordinate, by axis, of the triangle's vertices at the controls around the time,
// and for each degree: 2 x 4 for their interpolation, whose last two operations the tracer may fuse
// (core/base/lerp.h); 3 for rounding the position, the moved origin, and that origin in an instance's space.
// In all 11.
constexpr double kVertexError = 16 * 0x1p-24;
// Relative to the triangle's extent on any axis, since the test works on differences to the ray's origin and
// its shear mixes the axes: 1 for the difference, 3 for the shear, 5 for the distance. In all 9. Never 0, so
// that a ray does not start in the plane of a triangle that lies in a plane of coordinates.
constexpr double kTestError = 16 * 0x1p-24;
// A point's way out of an instance, relative to the sum of the sizes of its terms, for each degree: 2 x 4 for
// the interpolation of the matrix on either side, 2 for rounding the position and the moved origin. In
// all 10. The tracer inverts and applies the matrix in double precision, so that the way in adds nothing.
constexpr double kTransformError = 16 * 0x1p-24;

// A triangle at one time, in its mesh's space.
struct TrianglePose {
  Vec3d vertex[3];
  Vec3d size;  // by axis, the largest coordinate at the controls around the time
  std::uint32_t degree = 1;

  // How far the tracer's triangle may be from this one.
  Vec3d margin() const {
    const Vec3d extent =
        max(max(vertex[0], vertex[1]), vertex[2]) - min(min(vertex[0], vertex[1]), vertex[2]);
    const double test = kTestError * std::max({extent.x, extent.y, extent.z});
    return size * (kVertexError * degree) + Vec3d{test, test, test};
  }
};

TrianglePose pose_at(const TriangleMesh& shape, std::uint32_t triangle, float time) {
  const std::uint32_t first = locate(time, shape.segments).key * shape.degree;
  const std::uint32_t controls = shape.segments == 0 ? 1 : shape.degree + 1;
  TrianglePose pose;
  for (int corner = 0; corner < 3; ++corner) {
    const std::uint32_t vertex = shape.triangles[triangle][corner];
    pose.vertex[corner] = Vec3d(shape.position(vertex, time));
    for (std::uint32_t c = first; c < first + controls; ++c) {
      pose.size = max(pose.size, Vec3d(abs(shape.control_positions(c)[vertex])));
    }
  }
  pose.degree = shape.degree;
  return pose;
}

Affine3d abs(const Affine3d& a) {
  return {msbvh::abs(a.x), msbvh::abs(a.y), msbvh::abs(a.z), msbvh::abs(a.t)};
}

// An instance's transform at one time.
struct InstancePose {
  Affine3d world_from_object;
  Affine3d size;  // by element, the largest at the controls around the time
  std::uint32_t degree;

  InstancePose(const HitSource& source, float shutter_time) : degree(source.instances->degree) {
    const float time = source.instance_time(shutter_time);
    const TrackForm form = source.instances->form();
    const std::span<const Affine3f> controls = source.instance_controls();
    world_from_object = Affine3d(evaluate(controls, form, time));
    const std::uint32_t first = locate(time, form.segments).key * degree;
    size = abs(Affine3d(controls[first]));
    for (std::uint32_t c = first + 1; form.moving() && c <= first + degree; ++c) {
      const Affine3d m = abs(Affine3d(controls[c]));
      size = {max(size.x, m.x), max(size.y, m.y), max(size.z, m.z), max(size.t, m.t)};
    }
  }
};

// The triangle's own bound carried to the world, and that of the way there.
Vec3d instanced_margin(const TrianglePose& triangle, const InstancePose& instance) {
  const double error = kTransformError * instance.degree;
  return instance.size.vector(triangle.margin() + triangle.size * error) + instance.size.t * error;
}

// The instance's, else the mesh's, else `fallback`.
Vec3f display_color(const HitSource& source, const Hit& hit, float time, Vec3f fallback) {
  if (source.instances && !source.instances->display_color.empty()) {
    return source.instances->display_color[source.instance];
  }
  const Mesh& mesh = *source.mesh;
  if (!mesh.display_color.authored()) return fallback;
  return interpolate(mesh.display_color, mesh.shape, hit.triangle, Barycentrics::of(hit.u, hit.v), time);
}

// The instance's, else the triangle's.
const Material* material_of(const Scene& scene, const HitSource& source, const Hit& hit) {
  if (source.instances && !source.instances->materials.empty()) {
    return material_at(scene, source.instances->materials[source.instance]);
  }
  return material_of(scene, *source.mesh, hit.triangle);
}

void set_colors(const Material* material, const HitSource& source, const Hit& hit, float time,
                SurfacePoint& surface) {
  const Material standard{.diffuse_from_display_color = true};
  const Material& m = material ? *material : standard;
  const auto color = [&](Vec3f constant, bool from_display_color) {
    return from_display_color ? display_color(source, hit, time, constant) : constant;
  };
  surface.albedo = color(m.diffuse_color, m.diffuse_from_display_color);
  surface.emission = color(m.emissive_color, m.emissive_from_display_color);
}

// Two-sided: the normals end up on the side that the ray came from, so that neither the winding nor a
// mirroring transform matters.
void set_normals(const HitSource& source, const Hit& hit, const Ray& ray, const Affine3d& world_from_object,
                 const Vec3d& object_normal, SurfacePoint& surface) {
  const float time = source.mesh_time(ray.time);
  Vec3f ng(normalize(transform_normal(world_from_object, object_normal)));
  if (ng == Vec3f{}) ng = -normalize(ray.dir);  // no area left in double precision: nothing better is known
  if (dot(ng, ray.dir) > 0.0f) ng = -ng;
  surface.geometric_normal = surface.shading_normal = ng;
  const Mesh& mesh = *source.mesh;
  if (!mesh.normals.authored()) return;
  const Vec3d authored(
      interpolate(mesh.normals, mesh.shape, hit.triangle, Barycentrics::of(hit.u, hit.v), time));
  const Vec3f ns(normalize(transform_normal(world_from_object, authored)));
  if (ns == Vec3f{}) return;
  surface.shading_normal = dot(ns, ng) < 0.0f ? -ns : ns;
}

}  // namespace

SurfacePoint surface_at(const Scene& scene, const HitSource& source, const Hit& hit, const Ray& ray) {
  const float time = source.mesh_time(ray.time);
  const TrianglePose triangle = pose_at(source.mesh->shape, hit.triangle, time);
  const Vec3d edge1 = triangle.vertex[1] - triangle.vertex[0],
              edge2 = triangle.vertex[2] - triangle.vertex[0];
  const Vec3d in_object = triangle.vertex[0] + edge1 * double(hit.u) + edge2 * double(hit.v);
  SurfacePoint surface;
  if (source.instances) {
    const InstancePose instance(source, ray.time);
    surface.position = Vec3f(instance.world_from_object.point(in_object));
    surface.self_hit_margin = Vec3f(instanced_margin(triangle, instance));
    set_normals(source, hit, ray, instance.world_from_object, cross(edge1, edge2), surface);
  } else {
    surface.position = Vec3f(in_object);
    surface.self_hit_margin = Vec3f(triangle.margin());
    set_normals(source, hit, ray, Affine3d{}, cross(edge1, edge2), surface);
  }
  set_colors(material_of(scene, source, hit), source, hit, ray.time, surface);
  return surface;
}

float opacity_at(const Scene& scene, const HitSource& source, const Hit& hit, float time) {
  const Mesh& mesh = *source.mesh;
  const Material* material = material_of(scene, source, hit);
  if (!reads_display_opacity(mesh, material)) return constant_opacity(material);
  const float value =
      interpolate(mesh.display_opacity, mesh.shape, hit.triangle, Barycentrics::of(hit.u, hit.v), time);
  return rendered_opacity(material, value);
}

}  // namespace msbvh
