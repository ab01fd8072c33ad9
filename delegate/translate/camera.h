// The camera: checks, the frame's origin, and its track.
#pragma once

#include "core/scene/scene.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/translator.h"

namespace msbvh::translate {

// Throws Error naming the camera, what was found and what is expected.
void check_camera(const CameraInput& camera);

// Stage position of the camera at the shutter's centre: the origin of the frame's world.
Vec3d frame_origin(const CameraInput& camera);

// Fits matrix, window and lens together, so that points at several depths from the near plane to infinity are
// seen within a tenth of the tolerance of where the samples put them, the edge of their circle of confusion
// included: the camera's error adds to every object's.
Camera fit_camera(const CameraInput& camera, const Vec3d& origin, const TranslatorSettings& settings,
                  TrackReport& track);

}  // namespace msbvh::translate
