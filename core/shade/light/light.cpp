#include "core/shade/light/light.h"

#include <algorithm>

#include "core/motion/affine_track.h"
#include "core/shade/camera.h"
#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

LightValues between(const LightValues& a, const LightValues& b, float w) {
  return {lerp(a.radiance, b.radiance, w), lerp(a.angle_degrees, b.angle_degrees, w),
          lerp(a.radius, b.radius, w), lerp(a.width, b.width, w), lerp(a.height, b.height, w)};
}

PlacedLight place(const Light& light, const LightValues& values, float time) {
  return {values, evaluate(light.world_from_light, light.segments, time)};
}

}  // namespace

bool sample_camera_light(const LightValues& light, const Camera& camera, const Vec3f& point, float time,
                         LightSample& sample) {
  const Vec3f to_camera = camera_position(camera, time) - point;
  sample.distance = length(to_camera);
  if (sample.distance == 0.0f) return false;
  sample.direction = to_camera * (1.0f / sample.distance);
  sample.irradiance = light.radiance * kPi;
  sample.casts_shadow = false;
  return true;
}

LightValues values_at(const Light& light, float time) {
  if (light.moving_values.empty()) return light;
  const SegmentTime at = locate(time, light.segments);
  const LightValues& first = light.moving_values[at.key];
  return light.segments == 0 ? first : between(first, light.moving_values[at.key + 1], at.w);
}

bool sample_light(const Light& light, const Camera& camera, const Vec3f& point, float time, Point2 random,
                  LightSample& sample) {
  const LightValues values = values_at(light, time);
  if (values.radiance == Vec3f{}) return false;  // switched off, which needs no shadow ray
  switch (light.kind) {
    case LightKind::kDistant:
      return sample_distant(place(light, values, time), random, sample);
    case LightKind::kSphere:
      return sample_sphere(place(light, values, time), point, random, sample);
    case LightKind::kRect:
      return sample_rect(place(light, values, time), point, random, sample);
    case LightKind::kCamera:
      return sample_camera_light(values, camera, point, time, sample);
    case LightKind::kDome:
      break;
  }
  return false;
}

bool find_light(const Light& light, const Vec3f& point, const Vec3f& direction, float time,
                LightAlong& along) {
  const LightValues values = values_at(light, time);
  if (values.radiance == Vec3f{}) return false;
  switch (light.kind) {
    case LightKind::kDistant:
      return find_distant(place(light, values, time), direction, along);
    case LightKind::kSphere:
      return find_sphere(place(light, values, time), point, direction, along);
    case LightKind::kRect:
      return find_rect(place(light, values, time), point, direction, along);
    case LightKind::kCamera:
    case LightKind::kDome:
      break;
  }
  return false;
}

bool has_extent(const Light& light) {
  const auto any = [&](const auto& extended) {
    return light.moving_values.empty() ? extended(static_cast<const LightValues&>(light))
                                       : std::ranges::any_of(light.moving_values, extended);
  };
  switch (light.kind) {
    case LightKind::kDistant:
      return any([](const LightValues& v) { return v.angle_degrees > 0.0f; });
    case LightKind::kSphere:
      return any([](const LightValues& v) { return v.radius > 0.0f; });
    case LightKind::kRect:
      return any([](const LightValues& v) { return v.width > 0.0f && v.height > 0.0f; });
    case LightKind::kCamera:
    case LightKind::kDome:
      break;
  }
  return false;
}

}  // namespace msbvh
