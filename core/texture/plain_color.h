// Colours that come from no image, such as a light's or a surface's constant, in the rendering space.
#pragma once

#include <span>
#include <string>

namespace msbvh {

// OpenColorIO's name of linear Rec.709, which is what a colour is that nothing is said about.
inline constexpr const char* kLinearRec709 = "lin_rec709_scene";

// Red, green and blue of each colour, from one colour space to another by the rules of textures: "raw",
// "data", "identity" and "unknown" are as they are; empty is linear Rec.709; sRGB is the curve itself. Where
// both are the same, every bit stays. What the other space cannot hold is taken to its edge: numbers that
// become negative are 0. What is not finite stays so. Throws Error where one of them is no colour space.
void convert_colors(std::span<float> rgb, const std::string& from, const std::string& to);

}  // namespace msbvh
