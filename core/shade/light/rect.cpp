#include <cmath>
#include <limits>

#include "core/shade/light/shapes.h"

namespace msbvh {

Vec3f dark_area(const LightValues& values, const Affine3f& m) {
  const Vec3f area = cross(m.x * values.width, m.y * values.height);
  return dot(area, m.z) < 0.0f ? -area : area;  // a mirroring transform
}

bool sample_rect(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  const LightValues& values = light.values;
  const Vec3f on_light = light.world_from_light.point(
      {(random.x - 0.5f) * values.width, (random.y - 0.5f) * values.height, 0.0f});
  const Vec3f to_light = on_light - point;
  const float distance_squared = dot(to_light, to_light);
  const float projected_area_times_distance = dot(to_light, light.dark_area);
  if (!(projected_area_times_distance > 0.0f)) return false;
  sample.distance = std::sqrt(distance_squared);
  sample.direction = to_light * (1.0f / sample.distance);
  const float solid_angle = projected_area_times_distance / (distance_squared * sample.distance);
  if (!(solid_angle < std::numeric_limits<float>::infinity())) return false;  // its area or place overflows
  sample.irradiance = values.radiance * solid_angle;
  sample.pdf = 1.0f / solid_angle;
  return true;
}

bool find_rect(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  const Affine3f& m = light.world_from_light;
  const Vec3f& area = light.dark_area;
  const float facing = dot(direction, area);
  if (!(facing > 0.0f)) return false;
  const float distance = dot(m.t - point, area) / facing;
  if (!(distance > 0.0f)) return false;
  const Vec3f from_center = point + direction * distance - m.t;
  const Vec3f x = m.x * light.values.width, y = m.y * light.values.height, n = cross(x, y);
  const float half = 0.5f * dot(n, n);
  if (std::abs(dot(cross(from_center, y), n)) > half || std::abs(dot(cross(x, from_center), n)) > half)
    return false;
  along = {light.values.radiance, distance, distance * distance / facing};
  return true;
}

}  // namespace msbvh
