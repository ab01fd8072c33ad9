#include "core/shade/light/light_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

float image_mean(const Light& light) { return light.image ? light.image->mean : 1.0f; }

// Its irradiance at normal incidence, about, at such a distance squared where the light has a place.
float irradiance(const Light& light, const LightValues& values, float distance_squared) {
  const float radiance = std::max({values.radiance.x, values.radiance.y, values.radiance.z, 0.0f});
  switch (light.kind) {
    case LightKind::kDistant: {
      const float sine = std::sin(values.angle_degrees * (kPi / 360.0f));
      return radiance * (values.angle_degrees > 0.0f ? kPi * sine * sine : 1.0f);
    }
    case LightKind::kSphere: {
      const float radius = world_radius(values.radius, light.world_from_light.front());
      return radiance * (values.radius > 0.0f ? kPi * radius * radius : 1.0f) / distance_squared;
    }
    case LightKind::kRect:
      return radiance * image_mean(light) * length(dark_area(values, light.world_from_light.front())) /
             distance_squared;
    case LightKind::kDisk:
      return radiance * length(dark_disk_area(values.radius, light.world_from_light.front())) /
             distance_squared;
    case LightKind::kCylinder: {  // seen from its side
      const Affine3f& m = light.world_from_light.front();
      return radiance * 2.0f * values.radius * values.length * length(m.x) *
             std::sqrt(length(cross(m.y, m.z))) / distance_squared;
    }
    case LightKind::kCamera:
    case LightKind::kDome:
      break;
  }
  return radiance * image_mean(light) * kPi;
}

float most_irradiance(const Light& light, float distance_squared) {
  if (light.moving_values.empty()) return irradiance(light, light, distance_squared);
  float most = 0.0f;
  for (const LightValues& values : light.moving_values)
    most = std::max(most, irradiance(light, values, distance_squared));
  return most;
}

}  // namespace

LightSampler::LightSampler(const Scene& scene, const Box3f& bounds) {
  placed_.reserve(scene.lights.size());  // picks point into it
  for (const Light& light : scene.lights) {
    if (!shines(light)) continue;
    has_shadow_settings_ |= !(light.shadow == LightShadow{}) || !light.shadow_groups.empty();
    if (light.kind != LightKind::kDome || light.image) {
      const PlacedLight* still = is_still(light) ? &placed_.emplace_back(light, 0.0f) : nullptr;
      lights_.push_back({&light, still, 1.0f, has_extent(light)});
      continue;
    }
    has_dome_ = true;
    if (light.moving_values.empty()) {
      still_dome_radiance_ += light.radiance;
    } else {
      moving_domes_.push_back(&light);
    }
  }
  picks_ = static_cast<std::uint32_t>(std::min<std::size_t>(kLightPicks, lights_.size()));
  if (lights_.size() > kLightPicks) weigh(bounds);
}

void LightSampler::weigh(const Box3f& bounds) {
  const Vec3f half = (bounds.hi - bounds.lo) * 0.5f;
  const float distance_squared = dot(half, half);
  std::vector<float> given;
  double sum = 0.0;
  for (const LightPick& pick : lights_) {
    const float e = distance_squared > 0.0f ? most_irradiance(*pick.light, distance_squared) : 0.0f;
    given.push_back(e < std::numeric_limits<float>::infinity() ? e : 0.0f);  // NaN too
    sum += given.back();
  }
  const double alike = 1.0 / static_cast<double>(lights_.size());
  double total = 0.0;
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    const double chance = sum > 0.0 ? 0.5 * alike + 0.5 * given[i] / sum : alike;
    lights_[i].expected = static_cast<float>(chance * picks_);
    cumulative_.push_back(static_cast<float>(total += chance));
  }
}

LightPick LightSampler::pick(std::uint32_t which, float random) const {
  if (!by_chance()) return lights_[which];
  const float place = (static_cast<float>(which) + random) / static_cast<float>(picks_);
  const auto after = std::ranges::upper_bound(cumulative_, place);
  const auto last = static_cast<std::ptrdiff_t>(lights_.size()) - 1;
  return lights_[static_cast<std::size_t>(std::min(after - cumulative_.begin(), last))];
}

Vec3f LightSampler::image_domes_radiance(const Vec3f& direction, float time) const {
  Vec3f sum;
  for (const LightPick& pick : lights_) {
    LightAlong along;
    if (!is_image_dome(*pick.light)) continue;
    if (find_light(*pick.light, {}, direction, time, along)) sum += along.radiance;
  }
  return sum;
}

Vec3f LightSampler::moving_dome_radiance(float time) const {
  Vec3f sum = still_dome_radiance_;
  for (const Light* dome : moving_domes_) sum += values_at(*dome, time).radiance;
  return sum;
}

}  // namespace msbvh
