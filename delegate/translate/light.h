// Lights: checks and their tracks.
#pragma once

#include <optional>

#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/screen_measure.h"

namespace msbvh::translate {

// Finite lights follow their samples as geometry of their size does, in pixels through the camera. Of distant
// and dome lights only the directions matter: they are measured as if the unit sphere of directions filled
// the image. Returns nothing for a light that cannot be used (an error in the log).
std::optional<Light> translate_light(const LightInput& input, const ScreenMeasure& measure,
                                     const Vec3d& origin, std::uint32_t width, std::uint32_t height,
                                     const FitSettings& settings, PrimLog& log);

}  // namespace msbvh::translate
