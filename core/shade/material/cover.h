// What is transparent, and yet reflects: how much of its light such a surface takes away.
#pragma once

#include "core/scene/material.h"
#include "core/shade/bsdf/bsdf.h"

namespace msbvh {

// At one place.
struct Cover {
  float opacity = 1.0f;  // the material's
  float chance = 1.0f;   // that light meets the surface there, and does not pass straight through
  bool bends = false;    // what does not meet it is refracted, not seen straight through
};

// UsdPreviewSurface's opacityMode transparent: what is not opaque still reflects as glass does.
inline bool reflects_where_transparent(const Material* material) {
  return material && material->transparent_reflects && material->specular;
}

// What is left of straight light behind a surface: what its specular lobes do not reflect, by its opacity.
// The channel that is reflected most says how much.
float chance_to_meet(const SurfaceLook& look, float opacity, const Vec3f& shading_normal, const Vec3f& out);

}  // namespace msbvh
