#include "core/shade/material/texture_place.h"

#include <algorithm>
#include <cmath>

#include "core/shade/material/surface_values.h"
#include "core/shade/warp.h"
#include "core/shade/world_triangle.h"

namespace msbvh {
namespace {

// A footprint is at most this many times as long as wide.
constexpr float kLongest = 16.0f;

// Its value at the vertices of the triangle that was hit; none where it has one value there.
struct AtVertices {
  Vec3f value[3];
};

std::optional<AtVertices> at_vertices(const HitSource& source, const Hit& hit, PrimvarName name, float time) {
  Hit corner = hit;
  AtVertices at;
  const float u[3] = {0.0f, 1.0f, 0.0f}, v[3] = {0.0f, 0.0f, 1.0f};
  for (int i = 0; i < 3; ++i) {
    corner.u = u[i];
    corner.v = v[i];
    const std::optional<Vec3f> value = primvar_at(source, corner, name, time);
    if (!value) return std::nullopt;
    at.value[i] = *value;
  }
  return at;
}

}  // namespace

std::optional<TexturePlace> texture_place(const HitSource& source, const Hit& hit, const Ray& ray,
                                          PrimvarName name) {
  const std::optional<Vec3f> here = primvar_at(source, hit, name, ray.time);
  if (!here) return std::nullopt;
  TexturePlace place{here->x, here->y, {}, {}};
  if (!source.mesh && !source.grids) return place;
  const AtVertices at = *at_vertices(source, hit, name, ray.time);
  const Vec3f along_ab = at.value[1] - at.value[0], along_ac = at.value[2] - at.value[0];
  if (along_ab == Vec3f{} && along_ac == Vec3f{}) return place;
  const std::optional<InstancePose> pose = instance_pose(source, ray.time);
  const WorldTriangle triangle = world_triangle(source, pose, hit.triangle, ray.time);
  const Vec3d ab = triangle.vertex[1] - triangle.vertex[0], ac = triangle.vertex[2] - triangle.vertex[0];
  const Vec3d normal = cross(ab, ac);
  const double squared = dot(normal, normal);
  if (!(squared > 0.0)) return place;
  // Gradients of the barycentric coordinates: 1 along their own edge, 0 along the other.
  const Vec3d of_ab = cross(ac, normal) * (1.0 / squared), of_ac = cross(normal, ab) * (1.0 / squared);
  place.s_gradient = Vec3f(of_ab * double(along_ab.x) + of_ac * double(along_ac.x));
  place.t_gradient = Vec3f(of_ab * double(along_ab.y) + of_ac * double(along_ac.y));
  return place;
}

TextureQuery texture_query(const TextureRead& read, const std::optional<TexturePlace>& place,
                           const Vec3f& geometric_normal, const Vec3f& direction, float width) {
  const auto mapped = [&](float s, float t) {
    return Point2{read.matrix[0] * s + read.matrix[1] * t, read.matrix[2] * s + read.matrix[3] * t};
  };
  const Point2 at =
      place ? mapped(place->s, place->t) : mapped(read.fallback_coordinates[0], read.fallback_coordinates[1]);
  TextureQuery query{at.x + read.offset[0], at.y + read.offset[1], 0.0f, 0.0f, 0.0f, 0.0f};
  if (!place || !(width > 0.0f)) return query;
  // The cone meets the plane in an ellipse: as wide as the cone across the ray, longer along it.
  const float cosine = -dot(direction, geometric_normal);
  Vec3f across = cross(geometric_normal, direction);
  const float sine = length(across);
  across = sine > 1e-6f ? across * (1.0f / sine) : Basis(geometric_normal).x;
  const Vec3f along = cross(across, geometric_normal);
  const float longer = std::min(kLongest, 1.0f / std::max(1e-6f, cosine));
  const auto extent = [&](const Vec3f& axis, float size) {
    return mapped(dot(place->s_gradient, axis) * size, dot(place->t_gradient, axis) * size);
  };
  const Point2 x = extent(along, width * longer), y = extent(across, width);
  query.ds_dx = x.x;
  query.dt_dx = x.y;
  query.ds_dy = y.x;
  query.dt_dy = y.y;
  return query;
}

Vec3f bent_normal(const Vec3f& in_tangent_space, const Vec3f& shading_normal, const TexturePlace& place) {
  // The direction in which s grows and t does not, and the other way round.
  Vec3f s_axis = cross(place.t_gradient, shading_normal), t_axis = cross(shading_normal, place.s_gradient);
  const float handed = dot(s_axis, place.s_gradient) < 0.0f ? -1.0f : 1.0f;
  const float s_length = length(s_axis), t_length = length(t_axis);
  if (!(s_length > 0.0f) || !(t_length > 0.0f)) return shading_normal;
  s_axis = s_axis * (handed / s_length);
  t_axis = t_axis * (handed / t_length);
  // Square to each other, as the picture's axes are: what shears the coordinates does not shear bumps.
  const Vec3f square = t_axis - s_axis * dot(s_axis, t_axis);
  if (!(dot(square, square) > 1e-12f)) return shading_normal;
  const Vec3f& n = in_tangent_space;
  const Vec3f bent = s_axis * n.x + normalize(square) * n.y + shading_normal * n.z;
  const float size = length(bent);
  if (!(size > 0.0f) || !std::isfinite(size)) return shading_normal;
  const Vec3f unit = bent * (1.0f / size);
  return dot(unit, shading_normal) < 0.0f ? -unit : unit;
}

}  // namespace msbvh
