// UsdLux's ShapingAPI: what a light gives by the angle to its -z axis.
#pragma once

#include "core/shade/light/light.h"

namespace msbvh {

// Whether it gives the same in all directions in which it shines, at those values.
bool is_shaped(const Light& light, const LightValues& values);

// What is left of a light with a place, from which `to_light` leads to it: focus, cone and IES profile, by
// the formulas of UsdLuxShapingAPI's attributes.
Vec3f shaping(const PlacedLight& light, const Vec3f& to_light);

// Luminous intensity; angles in degrees, `vertical` in [0, 180], `horizontal` in [0, 360).
float ies_intensity(const IesProfile& profile, float vertical, float horizontal);

}  // namespace msbvh
