// The origin of a frame's world, where frames follow each other through a camera that somebody moves. A new
// one shifts all geometry by rounding, which refits every tree; the last one's costs precision far from it.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/vec.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Pixels by which single precision may shift what is as near as the camera sees.
inline constexpr double kOriginPixels = 0.02;

// The last frame's origin, in stage space, where the camera stays close enough to it over the shutter; none:
// the frame takes its own (TranslatorSettings::origin).
std::optional<Vec3d> kept_origin(const std::optional<Vec3d>& last, const CameraInput& camera,
                                 std::uint32_t width, std::uint32_t height);

}  // namespace msbvh::translate
