#include "core/shade/lights.h"

#include <cmath>
#include <limits>

#include "core/motion/affine_track.h"
#include "core/shade/camera.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A disc of directions about the light's +z axis. Without an extent, radiance stands for irradiance, since
// UsdLux's normalisation divides by nothing there.
bool sample_distant(const LightValues& light, const Affine3f& world_from_light, Point2 random,
                    LightSample& sample) {
  const Vec3f axis = normalize(world_from_light.z);
  if (axis == Vec3f{}) return false;
  sample.distance = kInfinity;
  sample.direction = axis;
  sample.irradiance = light.radiance;
  if (light.angle_degrees == 0.0f) return true;
  const float sine_of_half = std::sin(light.angle_degrees * (kPi / 720.0f));  // of half the cone's half angle
  const float one_minus_cos = 2.0f * sine_of_half * sine_of_half;
  sample.direction = normalize(Basis(axis)(sample_cone(random, one_minus_cos)));
  sample.irradiance = light.radiance * (2.0f * kPi * one_minus_cos);
  return true;
}

// UsdLux has no ellipsoids: a sphere under a transform that is not a similarity takes the radius of equal
// volume.
float world_radius(const LightValues& light, const Affine3f& world_from_light) {
  return light.radius * std::cbrt(std::abs(world_from_light.determinant()));
}

// Uniform in the cone that the sphere subtends (pbrt-v4, section 6.2.4), to the near side of the sphere.
bool sample_sphere(const LightValues& light, const Affine3f& world_from_light, const Vec3f& point,
                   Point2 random, LightSample& sample) {
  const Vec3f to_center = world_from_light.t - point;
  const float distance_squared = dot(to_center, to_center), distance = std::sqrt(distance_squared);
  const float radius = world_radius(light, world_from_light);
  if (distance <= radius) return false;  // inside: a sphere light shines outwards
  if (light.radius == 0.0f) {
    sample.direction = to_center * (1.0f / distance);
    sample.distance = distance;
    sample.irradiance = light.radiance * (1.0f / distance_squared);
    return true;
  }
  const float sine_squared = (radius / distance) * (radius / distance);
  const float one_minus_cos = sine_squared / (1.0f + std::sqrt(std::max(0.0f, 1.0f - sine_squared)));
  const Vec3f local = sample_cone(random, one_minus_cos);
  sample.direction = normalize(Basis(to_center * (1.0f / distance))(local));
  const float off_axis_squared = distance_squared * (1.0f - local.z * local.z);
  sample.distance = distance * local.z - std::sqrt(std::max(0.0f, radius * radius - off_axis_squared));
  sample.irradiance = light.radiance * (2.0f * kPi * one_minus_cos);
  return true;
}

// Uniform by area on the parallelogram that the transform makes of the rectangle.
bool sample_rect(const LightValues& light, const Affine3f& world_from_light, const Vec3f& point,
                 Point2 random, LightSample& sample) {
  const Vec3f on_light =
      world_from_light.point({(random.x - 0.5f) * light.width, (random.y - 0.5f) * light.height, 0.0f});
  const Vec3f to_light = on_light - point;
  const float distance_squared = dot(to_light, to_light);
  Vec3f area = cross(world_from_light.x * light.width, world_from_light.y * light.height);
  if (dot(area, world_from_light.z) < 0.0f) area = -area;           // a mirroring transform
  const float projected_area_times_distance = dot(to_light, area);  // > 0 on the side of -z, where it shines
  if (!(projected_area_times_distance > 0.0f)) return false;
  sample.distance = std::sqrt(distance_squared);
  sample.direction = to_light * (1.0f / sample.distance);
  sample.irradiance = light.radiance * (projected_area_times_distance / (distance_squared * sample.distance));
  return true;
}

// usdrecord's light: a white diffuse surface that faces the camera has the light's colour, at any distance.
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

LightValues between(const LightValues& a, const LightValues& b, float w) {
  return {lerp(a.radiance, b.radiance, w), lerp(a.angle_degrees, b.angle_degrees, w),
          lerp(a.radius, b.radius, w), lerp(a.width, b.width, w), lerp(a.height, b.height, w)};
}

// `light` must have moving values.
LightValues values_at(const Light& light, float time) {
  const SegmentTime at = locate(time, light.segments);
  const LightValues& first = light.moving_values[at.key];
  return light.segments == 0 ? first : between(first, light.moving_values[at.key + 1], at.w);
}

bool sample_placed(LightKind kind, const LightValues& values, const Affine3f& world_from_light,
                   const Vec3f& point, Point2 random, LightSample& sample) {
  switch (kind) {
    case LightKind::kDistant:
      return sample_distant(values, world_from_light, random, sample);
    case LightKind::kSphere:
      return sample_sphere(values, world_from_light, point, random, sample);
    case LightKind::kRect:
      return sample_rect(values, world_from_light, point, random, sample);
    case LightKind::kDome:
    case LightKind::kCamera:
      break;
  }
  return false;
}

bool sample_values(const Light& light, const LightValues& values, const Camera& camera, const Vec3f& point,
                   float time, Point2 random, LightSample& sample) {
  sample.casts_shadow = true;
  if (light.kind == LightKind::kCamera) return sample_camera_light(values, camera, point, time, sample);
  const Affine3f world_from_light = evaluate(light.world_from_light, light.segments, time);
  return sample_placed(light.kind, values, world_from_light, point, random, sample);
}

}  // namespace

bool sample_light(const Light& light, const Camera& camera, const Vec3f& point, float time, Point2 random,
                  LightSample& sample) {
  if (light.moving_values.empty()) {
    return sample_values(light, light, camera, point, time, random, sample);
  }
  const LightValues values = values_at(light, time);
  if (values.radiance == Vec3f{}) return false;  // switched off, which needs no shadow ray
  return sample_values(light, values, camera, point, time, random, sample);
}

LightSet::LightSet(const Scene& scene) {
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::kDome) {
      sampled.push_back(&light);
      continue;
    }
    has_dome = true;
    if (light.moving_values.empty()) {
      still_dome_radiance_ += light.radiance;
    } else {
      moving_domes_.push_back(&light);
    }
  }
}

Vec3f LightSet::moving_dome_radiance(float time) const {
  Vec3f sum = still_dome_radiance_;
  for (const Light* dome : moving_domes_) sum += values_at(*dome, time).radiance;
  return sum;
}

}  // namespace msbvh
