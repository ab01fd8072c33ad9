#include <algorithm>
#include <cmath>

#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// 1 - cos of the half angle of the cone that a sphere subtends.
float one_minus_cos(float radius, float distance) {
  const float sine_squared = (radius / distance) * (radius / distance);
  return sine_squared / (1.0f + std::sqrt(std::max(0.0f, 1.0f - sine_squared)));
}

}  // namespace

float world_radius(float radius, const Affine3f& world_from_light) {
  return radius * std::cbrt(std::abs(world_from_light.determinant()));
}

template <bool kExtended>
bool sample_sphere(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  const Vec3f to_center = light.world_from_light.t - point;
  const float distance_squared = dot(to_center, to_center), distance = std::sqrt(distance_squared);
  const float radius = light.radius;
  if (distance <= radius) return false;  // inside: a sphere light shines outwards
  if (!kExtended || light.values.radius == 0.0f) {
    sample.direction = to_center * (1.0f / distance);
    sample.distance = distance;
    sample.irradiance = light.values.radiance * (1.0f / distance_squared);
    sample.pdf = 0.0f;
    return true;
  }
  const float opening = one_minus_cos(radius, distance);
  const Vec3f local = sample_cone(random, opening);
  sample.direction = normalize(Basis(to_center * (1.0f / distance))(local));
  const float off_axis_squared = distance_squared * (1.0f - local.z * local.z);
  sample.distance = distance * local.z - std::sqrt(std::max(0.0f, radius * radius - off_axis_squared));
  sample.irradiance = light.values.radiance * (2.0f * kPi * opening);
  sample.pdf = 1.0f / (2.0f * kPi * opening);
  return true;
}

template bool sample_sphere<true>(const PlacedLight&, const Vec3f&, Point2, LightSample&);
template bool sample_sphere<false>(const PlacedLight&, const Vec3f&, Point2, LightSample&);

bool find_sphere(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  const Vec3f to_center = light.world_from_light.t - point;
  const float distance_squared = dot(to_center, to_center), nearest = dot(to_center, direction);
  const float radius = light.radius;
  const Vec3f across = to_center - direction * nearest;
  const float half_chord_squared = radius * radius - dot(across, across);
  if (!(nearest > 0.0f && half_chord_squared >= 0.0f && distance_squared > radius * radius)) return false;
  along.radiance = light.values.radiance;
  along.distance = nearest - std::sqrt(half_chord_squared);
  along.pdf = 1.0f / (2.0f * kPi * one_minus_cos(radius, std::sqrt(distance_squared)));
  return true;
}

}  // namespace msbvh
