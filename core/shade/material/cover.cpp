#include "core/shade/material/cover.h"

#include <algorithm>
#include <cmath>

namespace msbvh {

Cover transparent_cover(const SurfaceLook& look, float opacity, const Vec3f& shading_normal,
                        const Vec3f& out) {
  SurfaceLook clear = look;
  clear.diffuse = {};
  const Vec3f reflected = Bsdf(clear, shading_normal, out).albedo();
  const float most = std::clamp(std::max({reflected.x, reflected.y, reflected.z}), 0.0f, 1.0f);
  const float chance = 1.0f - (1.0f - opacity) * (1.0f - most);
  return {chance, opacity, chance > 0.0f ? 1.0f / chance : 0.0f, false};
}

Cover refracting_cover(const SurfaceLook& look, float opacity, const Vec3f& shading_normal,
                       const Vec3f& out) {
  if (std::abs(look.ior - 1.0f) < kLeastBend) return transparent_cover(look, opacity, shading_normal, out);
  return {1.0f - (1.0f - opacity) * (1.0f - look.metal), 1.0f, 1.0f, true};
}

}  // namespace msbvh
