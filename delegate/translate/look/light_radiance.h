// From UsdLux's inputs to radiance (UsdLux, "Light Contributions").
#pragma once

#include "core/base/vec.h"
#include "core/scene/light.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Inputs by which lights differ in size, with UsdLux's values for those that have none. Lengths are in stage
// units.
struct LightSizes {
  double angle_degrees = 0.53, radius = 0.5, width = 1.0, height = 1.0;
  bool operator==(const LightSizes&) const = default;
};

// intensity * 2^exposure * color; `temperature` is the black body's colour, white where it is not enabled.
// Infinite where it is too large.
Vec3d light_emission(double intensity, double exposure, const Vec3d& color, const Vec3d& temperature);

// What inputs:normalize divides by: the area in the world, for distant lights the cosine-weighted solid
// angle; 1 where that is 0.
double light_normalization(LightKind kind, const LightSizes& sizes, const Matrix4d& world_from_light);

// Radiance; of a sphere without a radius its radiant intensity.
Vec3d light_radiance(LightKind kind, const Vec3d& emission, const LightSizes& sizes, bool normalize,
                     const Matrix4d& world_from_light);

}  // namespace msbvh::translate
