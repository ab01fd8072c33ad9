#include "core/shade/round_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/shade/world_triangle.h"

namespace msbvh {
namespace {

// Origins of rays that leave stand off by this share of the radius: the tests' own rounding, relative to the
// radius, has a square root in it (of 2^-24), and a curve's place is found by Newton's method to about as
// much.
constexpr double kRadiusError = 0x1p-10;
// Roundings of 2^-24 of the largest coordinate and of the way of the ray: of the vertices' motion (3 a
// degree), the ray's origin, the difference, the projection and the distance.
constexpr double kPlaceError = 32 * 0x1p-24;

// Where something round was hit, in the space of its geometry.
struct RoundHit {
  Vec3d centre;          // of the ball that touches there
  double radius;         // of it
  Vec3d normal;          // unit, from the centre to the surface: what shading sees
  Vec3d flat;            // the geometric normal: another one on a ribbon alone
  double size;           // the largest coordinate
  bool through = false;  // nothing is inside: a ray that goes on starts behind it
};

double largest(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// The ray in the space of the geometry; its parameter keeps its meaning.
struct LocalRay {
  Vec3d org, dir;
  double size;  // the largest of the terms that the origin is a sum of: it errs by a share of them

  LocalRay(const Ray& ray, const std::optional<InstancePose>& pose) : org(ray.org), dir(ray.dir) {
    size = largest(org);
    if (!pose) return;
    const Affine3d object_from_world = inverse(pose->world_from_object);
    const auto& [x, y, z, t] = object_from_world;
    size = largest(abs(x) * std::abs(org.x) + abs(y) * std::abs(org.y) + abs(z) * std::abs(org.z) + abs(t));
    org = object_from_world.point(org);
    dir = object_from_world.vector(dir);
  }
  Vec3d at(double t) const { return org + dir * t; }
  // What a place on it errs by a share of.
  double size_at(double t) const { return std::max(size, std::abs(t) * length(dir)); }
};

Vec3d unit_or(const Vec3d& v, const Vec3d& fallback) {
  const Vec3d n = normalize(v);
  return is_finite(n) && n != Vec3d{} ? n : fallback;
}

// From the geometry's space to the world, and the place that rays leave from.
SurfaceHit in_world(const RoundHit& hit, const Ray& ray, float t, const std::optional<InstancePose>& pose) {
  const Affine3d map = pose ? pose->world_from_object : Affine3d{};
  const Vec3d d(ray.dir), place = map.point(hit.centre + hit.normal * hit.radius);
  const auto normal = [&](const Vec3d& n) { return unit_or(transform_normal(map, n), -normalize(d)); };
  Vec3d shading = normal(hit.normal), flat = normal(hit.flat);
  if (map.determinant() < 0.0) {  // transform_normal() keeps the right side of a mirror
    shading = -shading;
    flat = -flat;
  }
  const Vec3d outward = shading;
  const bool inside = dot(flat, d) > 0.0;
  if (inside) flat = -flat;
  if (dot(shading, flat) < 0.0) shading = -shading;
  const double radius = length(map.vector(hit.normal * hit.radius));
  const double size = std::max({largest(place), hit.size, std::abs(double(t)) * length(d)});
  const double margin = radius * kRadiusError + size * kPlaceError;

  SurfaceHit surface;
  surface.position = Vec3f(place);
  surface.geometric_normal = Vec3f(flat);
  surface.shading_normal = Vec3f(shading);
  surface.origin.need = hit.through ? radius + margin : margin;
  surface.origin.before = Vec3f(place + (inside && !hit.through ? -outward : outward) * margin);
  surface.origin.way = std::abs(double(t)) * length(d);
  surface.origin.cosine = -dot(flat, normalize(d));
  return surface;
}

// A span of a curve at one place and time.
struct CurvePlace {
  Vec3d centre, tangent;
  double radius, size;
  double growth;  // of the radius, along the centre line

  CurvePlace(const CurveSet& shape, std::uint32_t span, double u, float time) : size(0.0) {
    Vec3d p[kSpanVertices];
    double r[kSpanVertices];
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
      const RoundVertex v = shape.vertex(shape.spans[span] + i, time);
      p[i] = Vec3d(v.p);
      r[i] = double(v.radius);
      size = std::max(size, largest(p[i]) + r[i]);
    }
    centre = bezier([&](std::uint32_t i) { return p[i]; }, 3, u);
    radius = bezier([&](std::uint32_t i) { return r[i]; }, 3, u);
    tangent = bezier([&](std::uint32_t i) { return p[i + 1] - p[i]; }, 2, u);
    if (tangent == Vec3d{}) tangent = p[3] - p[0];
    const double speed = length(tangent);
    growth = speed > 0.0 ? bezier([&](std::uint32_t i) { return r[i + 1] - r[i]; }, 2, u) / speed : 0.0;
  }

  // From the centre to a hit, without how far along the curve the place has erred: on thin hair, far from the
  // origin, that would tilt the normal, and rays that leave along the hair would run into it. `lean`: how
  // far it is along the curve by rights. `hit_size`: what the hit errs by a share of.
  Vec3d outwards(const Vec3d& hit, double lean, double hit_size) const {
    const Vec3d out = hit - centre;
    const double l2 = dot(tangent, tangent);
    if (!(l2 > 0.0)) return out;
    const Vec3d unit = tangent * (1.0 / std::sqrt(l2));
    const double erred = dot(out, unit) - lean;
    const double most = radius * kRadiusError + std::max(size, hit_size) * kPlaceError;
    return std::abs(erred) <= most ? out - unit * erred : out;
  }
};

// Across the tangent, towards where the ray comes from.
Vec3d facing(const Vec3d& tangent, const Vec3d& dir) {
  const double l2 = dot(tangent, tangent);
  const Vec3d back = -normalize(dir);
  return unit_or(l2 > 0.0 ? back - tangent * (dot(tangent, back) / l2) : back, back);
}

RoundHit ribbon_hit(const CurvePlace& place, const LocalRay& ray, double t) {
  const Vec3d front = facing(place.tangent, ray.dir), at = ray.at(t);
  // How far across the hit is, as a share of the width; the rest goes round to the front.
  const Vec3d aside = place.outwards(at, 0.0, ray.size_at(t)), across = aside - front * dot(aside, front);
  const double share = place.radius > 0.0 ? std::min(length(across) / place.radius, 1.0) : 0.0;
  const Vec3d round = front * std::sqrt(1.0 - share * share) + unit_or(across, front) * share;
  const Vec3d normal = unit_or(round, front);
  return {place.centre, place.radius, normal, normal, place.size, true};
}

// `fibre`: what goes on through it has been scattered, and starts behind it.
RoundHit tube_hit(const CurvePlace& place, const LocalRay& ray, double t, bool fibre) {
  // The balls of a tube that grows touch it behind their centres.
  const Vec3d touched = place.outwards(ray.at(t), -place.growth * place.radius, ray.size_at(t));
  const Vec3d out = unit_or(touched, facing(place.tangent, ray.dir));
  return {place.centre, place.radius, out, out, place.size, fibre};
}

// A surface of its own: the ball that touches from the ray's side has no size.
RoundHit oriented_hit(const CurveSet& shape, const Hit& hit, const CurvePlace& place, const LocalRay& ray,
                      float time) {
  const auto normal = [&](std::uint32_t i) {
    return Vec3d(shape.normal(shape.spans[hit.triangle] + i, time));
  };
  const Vec3d authored = bezier(normal, 3, double(hit.u));
  const double l2 = dot(place.tangent, place.tangent);
  const Vec3d upright = l2 > 0.0 ? authored - place.tangent * (dot(authored, place.tangent) / l2) : authored;
  const Vec3d n = unit_or(upright, facing(place.tangent, ray.dir));
  return {ray.at(hit.t), 0.0, n, n, place.size + place.radius, false};
}

}  // namespace

SurfaceHit curve_surface(const HitSource& source, const Hit& hit, const Ray& ray) {
  const std::optional<InstancePose> pose = instance_pose(source, ray.time);
  const CurveSet& shape = source.curves->shape;
  const float time = source.own_time(ray.time);
  const LocalRay local(ray, pose);
  const CurvePlace place(shape, hit.triangle, hit.u, time);
  const RoundHit found = shape.shape == CurveShape::kRibbon ? ribbon_hit(place, local, hit.t)
                         : shape.shape == CurveShape::kTube
                             ? tube_hit(place, local, hit.t, source.curves->fibre)
                             : oriented_hit(shape, hit, place, local, time);
  return in_world(found, ray, hit.t, pose);
}

Vec3f curve_tangent(const HitSource& source, const Hit& hit, const Ray& ray) {
  const std::optional<InstancePose> pose = instance_pose(source, ray.time);
  const CurvePlace place(source.curves->shape, hit.triangle, hit.u, source.own_time(ray.time));
  return Vec3f(pose ? pose->world_from_object.vector(place.tangent) : place.tangent);
}

SurfaceHit point_surface(const HitSource& source, const Hit& hit, const Ray& ray) {
  const std::optional<InstancePose> pose = instance_pose(source, ray.time);
  const RoundVertex v = source.points->shape.vertex(hit.triangle, source.own_time(ray.time));
  const Vec3d centre(v.p);
  const LocalRay local(ray, pose);
  const Vec3d out = unit_or(local.at(hit.t) - centre, -normalize(local.dir));
  return in_world({centre, double(v.radius), out, out, largest(centre) + v.radius}, ray, hit.t, pose);
}

}  // namespace msbvh
