#include "core/shade/surface_hit.h"

#include "core/scene/opacity.h"
#include "core/shade/round_surface.h"
#include "core/shade/value_at.h"
#include "core/shade/world_triangle.h"

namespace msbvh {
namespace {

Vec3f instance_color(const InstanceSet& set, std::size_t instance, float time) {
  const SegmentTime at = locate(time, set.color_segments);
  const std::size_t count = instance_count(set);
  const Vec3f first = set.display_color[at.key * count + instance];
  if (set.color_segments == 0) return first;
  return lerp(first, set.display_color[(at.key + 1) * count + instance], at.w);
}

// The instance's, else the geometry's, else `fallback`.
template <EffectSet kEffects>
Vec3f display_color(const HitSource& source, const Hit& hit, float time, Vec3f fallback) {
  if (kEffects.has(Effect::kInstances) && source.instances && !source.instances->display_color.empty()) {
    return instance_color(*source.instances, source.instance, time);
  }
  if (!source.look->display_color.authored()) return fallback;
  return value_at<kEffects>(source.look->display_color, source, hit, time);
}

template <EffectSet kEffects>
const Material* material_of(const Scene& scene, const HitSource& source, const Hit& hit) {
  return material_at(scene, material_index<kEffects>(source, hit));
}

template <EffectSet kEffects>
void set_colors(const Material* material, const HitSource& source, const Hit& hit, float time,
                SurfaceHit& surface) {
  static const Material standard{.diffuse_from_display_color = true};
  const Material& m = material ? *material : standard;
  const auto color = [&](Vec3f constant, bool from_display_color) {
    return from_display_color ? display_color<kEffects>(source, hit, time, constant) : constant;
  };
  surface.albedo = color(m.diffuse_color, m.diffuse_from_display_color);
  surface.emission = color(m.emissive_color, m.emissive_from_display_color);
}

// Of a triangle that has no area left in double precision: across the line, as far as there is one.
Vec3d line_normal(const WorldTriangle& triangle, const Vec3d& d) {
  const Vec3d* v = triangle.vertex;
  const Vec3d a = v[1] - v[0], b = v[2] - v[0], c = v[2] - v[1];
  const Vec3d ab = dot(a, a) > dot(b, b) ? a : b, longest = dot(ab, ab) > dot(c, c) ? ab : c;
  const double l2 = dot(longest, longest);
  const Vec3d across = l2 > 0.0 ? longest * (dot(longest, d) / l2) - d : -d;
  return normalize(across == Vec3d{} ? -d : across);
}

// Where the mesh has none, the geometric one. Turned to the side that the ray came from. Out of line, since
// g++ inlines it or not by what else the build has, and it spills registers where it is inlined.
template <EffectSet kEffects>
[[gnu::noinline]] Vec3f shading_normal(const HitSource& source, const Hit& hit, float mesh_time,
                                       const std::optional<InstancePose>& pose, const Vec3f& ng) {
  const Primvar<Vec3f>& normals =
      !kEffects.has(Effect::kDisplacement) || source.mesh ? source.mesh->normals : source.grids->normals;
  if (!normals.authored()) return ng;
  const Vec3f authored = value_at<kEffects>(normals, source, hit, mesh_time);
  const Vec3d in_world = kEffects.has(Effect::kInstances) && pose
                             ? transform_normal(pose->world_from_object, Vec3d(authored))
                             : Vec3d(authored);
  const Vec3f ns(normalize(in_world));
  if (ns == Vec3f{}) return ng;
  return dot(ns, ng) < 0.0f ? -ns : ns;
}

// Without its colours.
template <EffectSet kEffects>
SurfaceHit triangle_surface(const HitSource& source, const Hit& hit, const Ray& ray) {
  const std::optional<InstancePose> pose = instance_pose<kEffects>(source, ray.time);
  const WorldTriangle triangle = world_triangle<kEffects>(source, pose, hit.triangle, ray.time);
  const Vec3d &a = triangle.vertex[0], ab = triangle.vertex[1] - a, ac = triangle.vertex[2] - a;
  const Vec3d position = a + ab * double(hit.u) + ac * double(hit.v), d(ray.dir);
  // Two-sided: normals are turned to the side that the ray came from, so that neither the winding nor a
  // mirroring transform matters.
  const Vec3d across = cross(ab, ac);
  const double doubled_area = length(across);
  Vec3d normal = doubled_area > 0.0 ? across * (1.0 / doubled_area) : line_normal(triangle, d);
  if (dot(normal, d) > 0.0) normal = -normal;
  SurfaceHit surface;
  surface.position = Vec3f(position);
  surface.geometric_normal = Vec3f(normal);
  surface.shading_normal = shading_normal<kEffects>(source, hit, source.own_time<kEffects>(ray.time), pose,
                                                    surface.geometric_normal);
  surface.origin = origin_at(triangle, hit, ray, position, normal, doubled_area);
  return surface;
}

}  // namespace

template <EffectSet kEffects>
SurfaceHit surface_at(const Scene& scene, const HitSource& source, const Hit& hit, const Ray& ray) {
  constexpr bool kCurves = kEffects.has(Effect::kCurves), kPoints = kEffects.has(Effect::kPoints);
  SurfaceHit surface = kCurves && source.curves   ? curve_surface(source, hit, ray)
                       : kPoints && source.points ? point_surface(source, hit, ray)
                                                  : triangle_surface<kEffects>(source, hit, ray);
  set_colors<kEffects>(material_of<kEffects>(scene, source, hit), source, hit, ray.time, surface);
  return surface;
}

template <EffectSet kEffects>
std::uint32_t material_index(const HitSource& source, const Hit& hit) {
  if (kEffects.has(Effect::kInstances) && source.instances && !source.instances->materials.empty())
    return source.instances->materials[source.instance];
  if (kEffects.has(Effect::kDisplacement) && source.grids) return material_index(*source.grids, hit.triangle);
  constexpr bool kRound = kEffects.has(Effect::kCurves) || kEffects.has(Effect::kPoints);
  return !kRound || source.mesh ? material_index(*source.mesh, hit.triangle) : source.look->material;
}

float opacity_at(const Scene& scene, const HitSource& source, const Hit& hit, float time) {
  const Material* material = material_of<kKnownEffects>(scene, source, hit);
  if (source.instances && !source.instances->display_opacity.empty() &&
      (!material || material->opacity_from_display_opacity))
    return rendered_opacity(material, source.instances->display_opacity[source.instance]);
  if (!reads_display_opacity(*source.look, material)) return constant_opacity(material);
  return rendered_opacity(material, value_at<kKnownEffects>(source.look->display_opacity, source, hit, time));
}

template SurfaceHit surface_at<kPlain>(const Scene&, const HitSource&, const Hit&, const Ray&);
template SurfaceHit surface_at<kKnownEffects>(const Scene&, const HitSource&, const Hit&, const Ray&);
template std::uint32_t material_index<kPlain>(const HitSource&, const Hit&);
template std::uint32_t material_index<kKnownEffects>(const HitSource&, const Hit&);

}  // namespace msbvh
