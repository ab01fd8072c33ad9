// What every geometry has on it, whatever its kind.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/vec.h"
#include "core/scene/material.h"
#include "core/scene/primvar.h"

namespace msbvh {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// A primvar that materials read by its name.
struct SurfacePrimvar {
  PrimvarName name = kNoPrimvar;  // each once
  Primvar<Vec3f> primvar;         // of one to three numbers, the rest 0; in the shutter's time
};

struct Appearance {
  // In the shutter's time.
  Primvar<Vec3f> display_color;
  Primvar<float> display_opacity;
  std::vector<SurfacePrimvar> primvars;
  std::uint32_t material = kNone;  // kNone: diffuse in display_color (0.18 grey where not authored)
  std::uint32_t prim_id = kNone;   // for AOVs, the prim's; kNone: the geometry's place in the scene
  std::uint32_t light_group =
      0;  // which lights illuminate it and which shadows it casts (core/scene/light.h)
};

}  // namespace msbvh
