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

}  // namespace

PlacedLight::PlacedLight(const Light& light, float time) : kind(light.kind), values(values_at(light, time)) {
  if (kind == LightKind::kCamera || kind == LightKind::kDome) return;
  world_from_light = evaluate(light.world_from_light, light.segments, time);
  if (kind == LightKind::kDistant) {
    axis = normalize(world_from_light.z);
    opening = distant_opening(values.angle_degrees);
  }
  if (kind == LightKind::kSphere) radius = world_radius(values.radius, world_from_light);
  if (kind == LightKind::kRect) dark_area = msbvh::dark_area(values, world_from_light);
}

bool sample_camera_light(const PlacedLight& light, const Camera& camera, const Vec3f& point, float time,
                         LightSample& sample) {
  const Vec3f to_camera = camera_position(camera, time) - point;
  sample.distance = length(to_camera);
  if (sample.distance == 0.0f) return false;
  sample.direction = to_camera * (1.0f / sample.distance);
  sample.irradiance = light.values.radiance * kPi;
  sample.pdf = 0.0f;
  sample.casts_shadow = false;
  return true;
}

LightValues values_at(const Light& light, float time) {
  if (light.moving_values.empty()) return light;
  const SegmentTime at = locate(time, light.segments);
  const LightValues& first = light.moving_values[at.key];
  return light.segments == 0 ? first : between(first, light.moving_values[at.key + 1], at.w);
}

template <bool kExtended>
bool sample_light(const PlacedLight& light, const Camera& camera, const Vec3f& point, float time,
                  Point2 random, LightSample& sample) {
  if (light.values.radiance == Vec3f{}) return false;  // switched off, which needs no shadow ray
  sample.casts_shadow = true;
  switch (light.kind) {
    case LightKind::kDistant:
      return sample_distant<kExtended>(light, random, sample);
    case LightKind::kSphere:
      return sample_sphere<kExtended>(light, point, random, sample);
    case LightKind::kRect:
      return kExtended && sample_rect(light, point, random, sample);
    case LightKind::kCamera:
      return sample_camera_light(light, camera, point, time, sample);
    case LightKind::kDome:
      break;
  }
  return false;
}

template <bool kExtended>
bool sample_light(const Light& light, const Camera& camera, const Vec3f& point, float time, Point2 random,
                  LightSample& sample) {
  return sample_light<kExtended>(PlacedLight(light, time), camera, point, time, random, sample);
}

template bool sample_light<true>(const PlacedLight&, const Camera&, const Vec3f&, float, Point2,
                                 LightSample&);
template bool sample_light<false>(const PlacedLight&, const Camera&, const Vec3f&, float, Point2,
                                  LightSample&);
template bool sample_light<true>(const Light&, const Camera&, const Vec3f&, float, Point2, LightSample&);
template bool sample_light<false>(const Light&, const Camera&, const Vec3f&, float, Point2, LightSample&);

bool find_light(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  if (light.values.radiance == Vec3f{}) return false;
  switch (light.kind) {
    case LightKind::kDistant:
      return find_distant(light, direction, along);
    case LightKind::kSphere:
      return find_sphere(light, point, direction, along);
    case LightKind::kRect:
      return find_rect(light, point, direction, along);
    case LightKind::kCamera:
    case LightKind::kDome:
      break;
  }
  return false;
}

bool find_light(const Light& light, const Vec3f& point, const Vec3f& direction, float time,
                LightAlong& along) {
  return find_light(PlacedLight(light, time), point, direction, along);
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
