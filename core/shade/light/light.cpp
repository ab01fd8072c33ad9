#include "core/shade/light/light.h"

#include <algorithm>

#include "core/motion/affine_track.h"
#include "core/shade/camera.h"
#include "core/shade/light/shapes.h"
#include "core/shade/light/shaping.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

LightValues between(const LightValues& a, const LightValues& b, float w) {
  return {lerp(a.radiance, b.radiance, w),
          lerp(a.angle_degrees, b.angle_degrees, w),
          lerp(a.radius, b.radius, w),
          lerp(a.width, b.width, w),
          lerp(a.height, b.height, w),
          lerp(a.length, b.length, w),
          lerp(a.focus, b.focus, w),
          lerp(a.cone_angle_degrees, b.cone_angle_degrees, w),
          lerp(a.cone_softness, b.cone_softness, w),
          lerp(a.diffuse, b.diffuse, w),
          lerp(a.specular, b.specular, w)};
}

bool needs_inverse(const PlacedLight& light) {
  return light.kind == LightKind::kCylinder || (light.shaped && light.source->ies.profile);
}

// By a light's kind alone.
template <bool kExtended, bool kControls>
bool sample_kind(const PlacedLight& light, const Camera& camera, const Vec3f& point, float time,
                 Point2 random, LightSample& sample) {
  switch (light.kind) {
    case LightKind::kDistant:
      return sample_distant<kExtended>(light, random, sample);
    case LightKind::kSphere:
      return sample_sphere<kExtended>(light, point, random, sample);
    case LightKind::kRect:
      if (kControls && light.source->image)
        return kExtended && sample_image_rect(light, point, random, sample);
      return kExtended && sample_rect(light, point, random, sample);
    case LightKind::kDisk:
      return kExtended && sample_disk(light, point, random, sample);
    case LightKind::kCylinder:
      return kExtended && sample_cylinder(light, point, random, sample);
    case LightKind::kDome:
      return kExtended && light.source->image && sample_dome(light, point, random, sample);
    case LightKind::kCamera:
      return sample_camera_light(light, camera, point, time, sample);
    case LightKind::kMesh:  // mesh_light.h
      break;
  }
  return false;
}

template <bool kControls>
bool find_kind(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  switch (light.kind) {
    case LightKind::kDistant:
      return find_distant(light, direction, along);
    case LightKind::kSphere:
      return find_sphere(light, point, direction, along);
    case LightKind::kRect:
      if (kControls && light.source->image) return find_image_rect(light, point, direction, along);
      return find_rect(light, point, direction, along);
    case LightKind::kDisk:
      return find_disk(light, point, direction, along);
    case LightKind::kCylinder:
      return find_cylinder(light, point, direction, along);
    case LightKind::kDome:
      return light.source->image && find_dome(light, point, direction, along);
    case LightKind::kCamera:
    case LightKind::kMesh:
      break;
  }
  return false;
}

}  // namespace

PlacedLight::PlacedLight(const Light& light, float time)
    : kind(light.kind), values(values_at(light, time)), source(&light), time(time) {
  if (is_placeless(light)) return;
  world_from_light = evaluate(light.world_from_light, light.segments, time);
  if (kind == LightKind::kDistant) {
    axis = normalize(world_from_light.z);
    opening = distant_opening(values.angle_degrees);
  }
  if (kind == LightKind::kSphere) radius = world_radius(values.radius, world_from_light);
  if (kind == LightKind::kRect) dark_area = msbvh::dark_area(values, world_from_light);
  if (kind == LightKind::kDisk) dark_area = dark_disk_area(values.radius, world_from_light);
  if (kind == LightKind::kDome) world_from_light = dome_rotation(world_from_light);
  shaped = is_shaped(light, values);
  if (shaped) axis = normalize(world_from_light.z);
  if (!needs_inverse(*this)) return;
  if (world_from_light.determinant() == 0.0f) {
    values.radiance = {};  // flattened: of no extent, or facing nowhere
  } else {
    light_from_world = inverse(world_from_light);
  }
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

template <bool kExtended, bool kControls>
bool sample_light(const PlacedLight& light, const Camera& camera, const Vec3f& point, float time,
                  Point2 random, LightSample& sample) {
  if (light.values.radiance == Vec3f{}) return false;  // switched off, which needs no shadow ray
  sample.casts_shadow = true;
  if (!sample_kind<kExtended, kControls>(light, camera, point, time, random, sample)) return false;
  if constexpr (!kControls) return true;
  sample.diffuse = light.values.diffuse;
  sample.specular = light.values.specular;
  if (light.shaped) sample.irradiance = sample.irradiance * shaping(light, sample.direction);
  return !(sample.irradiance == Vec3f{});
}

template <bool kExtended, bool kControls>
bool sample_light(const Light& light, const Camera& camera, const Vec3f& point, float time, Point2 random,
                  LightSample& sample) {
  return sample_light<kExtended, kControls>(PlacedLight(light, time), camera, point, time, random, sample);
}

template <bool kControls>
bool find_light(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  if (light.values.radiance == Vec3f{}) return false;
  if (!find_kind<kControls>(light, point, direction, along)) return false;
  if constexpr (!kControls) return true;
  along.diffuse = light.values.diffuse;
  along.specular = light.values.specular;
  if (light.shaped) along.radiance = along.radiance * shaping(light, direction);
  return !(along.radiance == Vec3f{});
}

template <bool kControls>
bool find_light(const Light& light, const Vec3f& point, const Vec3f& direction, float time,
                LightAlong& along) {
  return find_light<kControls>(PlacedLight(light, time), point, direction, along);
}

template bool sample_light<false, false>(const PlacedLight&, const Camera&, const Vec3f&, float, Point2,
                                         LightSample&);
template bool sample_light<false, false>(const Light&, const Camera&, const Vec3f&, float, Point2,
                                         LightSample&);
template bool sample_light<false, true>(const PlacedLight&, const Camera&, const Vec3f&, float, Point2,
                                        LightSample&);
template bool sample_light<false, true>(const Light&, const Camera&, const Vec3f&, float, Point2,
                                        LightSample&);
template bool sample_light<true, false>(const PlacedLight&, const Camera&, const Vec3f&, float, Point2,
                                        LightSample&);
template bool sample_light<true, false>(const Light&, const Camera&, const Vec3f&, float, Point2,
                                        LightSample&);
template bool sample_light<true, true>(const PlacedLight&, const Camera&, const Vec3f&, float, Point2,
                                       LightSample&);
template bool sample_light<true, true>(const Light&, const Camera&, const Vec3f&, float, Point2,
                                       LightSample&);

template bool find_light<false>(const PlacedLight&, const Vec3f&, const Vec3f&, LightAlong&);
template bool find_light<true>(const PlacedLight&, const Vec3f&, const Vec3f&, LightAlong&);
template bool find_light<false>(const Light&, const Vec3f&, const Vec3f&, float, LightAlong&);
template bool find_light<true>(const Light&, const Vec3f&, const Vec3f&, float, LightAlong&);

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
    case LightKind::kDisk:
      return any([](const LightValues& v) { return v.radius > 0.0f; });
    case LightKind::kCylinder:
      return any([](const LightValues& v) { return v.radius > 0.0f && v.length > 0.0f; });
    case LightKind::kDome:
      return light.image != nullptr;
    case LightKind::kCamera:
    case LightKind::kMesh:
      break;
  }
  return false;
}

}  // namespace msbvh
