// What a surface is made of.
#pragma once

#include <string>

#include "core/base/vec.h"

namespace msbvh {

// The constants of a UsdPreviewSurface that the diffuse model uses.
struct Material {
  std::string name{};
  Vec3f diffuse_color{0.18f, 0.18f, 0.18f};
  bool diffuse_from_display_color = false;  // diffuseColor is connected to a reader of primvars:displayColor
  Vec3f emissive_color{};
  bool emissive_from_display_color = false;  // likewise of emissiveColor
  float opacity = 1.0f;
  bool opacity_from_display_opacity = false;
  float opacity_threshold = 0.0f;  // > 0: opacity below it counts as 0, else as 1 (UsdPreviewSurface)
};

}  // namespace msbvh
