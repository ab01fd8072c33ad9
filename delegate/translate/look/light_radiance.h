// From UsdLux's inputs to radiance (UsdLux, "Light Contributions").
#pragma once

#include <array>

#include "core/base/vec.h"
#include "core/scene/light.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Inputs that are numbers and may change inside the shutter, with the values of lights that have none.
// Lengths are in stage units.
struct LightNumbers {
  double angle_degrees = 0.53, radius = 0.5, width = 1.0, height = 1.0, length = 1.0;
  double focus = 0.0, cone_angle_degrees = 180.0, cone_softness = 0.0, diffuse = 1.0, specular = 1.0;
  bool operator==(const LightNumbers&) const = default;
};

// Each: its name behind "inputs:", where front-ends read and where the core keeps it. The sizes come first.
struct LightNumber {
  const char* input;
  double LightNumbers::*number;
  float LightValues::*value;
};
inline constexpr std::size_t kLightSizes = 5;
inline constexpr std::array<LightNumber, 10> kLightNumbers{{
    {"angle", &LightNumbers::angle_degrees, &LightValues::angle_degrees},
    {"radius", &LightNumbers::radius, &LightValues::radius},
    {"width", &LightNumbers::width, &LightValues::width},
    {"height", &LightNumbers::height, &LightValues::height},
    {"length", &LightNumbers::length, &LightValues::length},
    {"shaping:focus", &LightNumbers::focus, &LightValues::focus},
    {"shaping:cone:angle", &LightNumbers::cone_angle_degrees, &LightValues::cone_angle_degrees},
    {"shaping:cone:softness", &LightNumbers::cone_softness, &LightValues::cone_softness},
    {"diffuse", &LightNumbers::diffuse, &LightValues::diffuse},
    {"specular", &LightNumbers::specular, &LightValues::specular},
}};

// As the core has them: what UsdLux clamps or ignores is so here.
LightValues light_values(const Vec3d& radiance, const LightNumbers& numbers);

// intensity * 2^exposure * color; `temperature` is the black body's colour, white where it is not enabled.
// Infinite where it is too large.
Vec3d light_emission(double intensity, double exposure, const Vec3d& color, const Vec3d& temperature);

// What inputs:normalize divides by: the area in the world, for distant lights the cosine-weighted solid
// angle; 1 where that is 0.
double light_normalization(LightKind kind, const LightNumbers& sizes, const Matrix4d& world_from_light);

// Radiance; of a sphere without a radius its radiant intensity.
Vec3d light_radiance(LightKind kind, const Vec3d& emission, const LightNumbers& sizes, bool normalize,
                     const Matrix4d& world_from_light);

}  // namespace msbvh::translate
