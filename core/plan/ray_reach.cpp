#include "core/plan/ray_reach.h"

#include <algorithm>

namespace msbvh {

bool anything_shines(const Scene& scene) {
  const auto glows = [](const Material& material) {
    return material.emissive_from_display_color || !(material.emissive_color == Vec3f{});
  };
  return std::ranges::any_of(scene.lights, shines) || std::ranges::any_of(scene.materials, glows);
}

bool goes_beyond_camera_rays(const Scene& scene, std::uint32_t max_bounces) {
  const auto casts_shadows = [](const Light& light) {
    return shines(light) && light.kind != LightKind::kCamera;
  };
  return std::ranges::any_of(scene.lights, casts_shadows) || (max_bounces > 0 && anything_shines(scene));
}

}  // namespace msbvh
