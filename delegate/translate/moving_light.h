// The track of a light whose brightness or size changes inside the shutter.
#pragma once

#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {

// Power is the light's radiance times its size (area in the world; for distant lights the solid angle): what
// it gives to the scene. The track's may stray from the samples' by this share of the largest.
inline constexpr double kPowerTolerance = 0.01;

// The fewest segments that follow transform and size as well as a still light's transform is followed, and
// power within kPowerTolerance. Where values jump, as many as there may be: they cost a light nothing, and
// make the jump as short as it can be; radiance over the whole shutter is kept (see value_track.h). `light`
// comes with its kind and gets segments, world_from_light and moving_values; the latter stay empty, and the
// light's own values become those of the samples, where nothing changes.
void fit_moving_light(const LightInput& input, const TransformTrack& transform, const ScreenMeasure& measure,
                      const FitSettings& settings, Light& light, PrimLog& log);

}  // namespace msbvh::translate
