// What every geometry has on it, whatever its kind.
#pragma once

#include <cstdint>
#include <limits>

#include "core/base/vec.h"
#include "core/scene/primvar.h"

namespace msbvh {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct Appearance {
  // In the shutter's time.
  Primvar<Vec3f> display_color;
  Primvar<float> display_opacity;
  std::uint32_t material = kNone;  // kNone: diffuse in display_color (0.18 grey where not authored)
  std::uint32_t prim_id = kNone;   // for AOVs, the prim's; kNone: the geometry's place in the scene
};

}  // namespace msbvh
