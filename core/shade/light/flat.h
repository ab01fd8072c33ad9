// What flat lights share: places of them are sampled evenly by area.
#pragma once

#include <cmath>
#include <limits>

#include "core/shade/light/light.h"

namespace msbvh {

// `on_light`: the place; `area`: normal on the side where the light does not shine, as long as the area over
// the density of the place, relative to an even one.
inline bool sample_area(const Vec3f& radiance, const Vec3f& area, const Vec3f& on_light, const Vec3f& point,
                        LightSample& sample) {
  const Vec3f to_light = on_light - point;
  const float distance_squared = dot(to_light, to_light);
  const float projected_area_times_distance = dot(to_light, area);
  if (!(projected_area_times_distance > 0.0f)) return false;
  sample.distance = std::sqrt(distance_squared);
  sample.direction = to_light * (1.0f / sample.distance);
  const float solid_angle = projected_area_times_distance / (distance_squared * sample.distance);
  if (!(solid_angle < std::numeric_limits<float>::infinity())) return false;  // its area or place overflows
  sample.irradiance = radiance * solid_angle;
  sample.pdf = 1.0f / solid_angle;
  return true;
}

// Where a ray meets the plane of a light, in its two edges `x` and `y` from the middle. False where it does
// not, or from the dark side.
struct FlatPlace {
  float distance;
  float pdf;   // of an even density
  float u, v;  // of the edges, times `scale`
  float scale;
};

inline bool find_flat(const Vec3f& middle, const Vec3f& x, const Vec3f& y, const Vec3f& area,
                      const Vec3f& point, const Vec3f& direction, FlatPlace& place) {
  const float facing = dot(direction, area);
  if (!(facing > 0.0f)) return false;
  place.distance = dot(middle - point, area) / facing;
  if (!(place.distance > 0.0f)) return false;
  const Vec3f from_center = point + direction * place.distance - middle, n = cross(x, y);
  place.u = dot(cross(from_center, y), n);
  place.v = dot(cross(x, from_center), n);
  place.scale = dot(n, n);
  place.pdf = place.distance * place.distance / facing;
  return true;
}

}  // namespace msbvh
