// How light meets a surface that is not opaque.
#pragma once

#include "core/scene/material.h"
#include "core/shade/bsdf/bsdf.h"

namespace msbvh {

// At one place.
struct Cover {
  float chance = 1.0f;   // that light meets the surface, and does not pass straight through
  float diffuse = 1.0f;  // where it meets it: what is left of the diffuse lobe,
  float weight = 1.0f;   // and by what the surface's light is multiplied
  bool bends = false;    // what does not meet it is refracted, not seen straight through
};

// UsdPreviewSurface's opacityMode transparent: what is not opaque still reflects as glass does.
inline bool reflects_where_transparent(const Material* material) {
  return material && material->transparent_reflects && material->specular;
}

// Seen straight through: behind the surface is left, by its opacity, what its specular lobes do not reflect,
// of that channel that is reflected most. Specular lobes give what they would on an opaque surface, the
// diffuse one its share by opacity.
Cover transparent_cover(const SurfaceLook& look, float opacity, const Vec3f& shading_normal,
                        const Vec3f& out);

// Refracted instead: the surface is of glass by what opacity and metal leave, and opaque otherwise.
// Where the ior is 1 but for kLeastBend nothing is bent: as transparent_cover().
inline constexpr float kLeastBend = 0.01f;
Cover refracting_cover(const SurfaceLook& look, float opacity, const Vec3f& shading_normal, const Vec3f& out);

}  // namespace msbvh
