// UsdGeomMotionAPI's scales: motion:blurScale, by which a prim's shutter is scaled about the frame, and
// motion:velocityScale. motion:nonlinearSampleCount says how often renderers sample that cannot take
// accelerations and angular velocities as they are; this one can, and reads it nowhere.
#pragma once

#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

// Where a scale comes from, for messages, and the least that makes sense: 0 for a blurScale.
struct ScaleSource {
  std::string path{};
  std::string attribute = "motion:blurScale";
  double least = 0.0;
};

// A finite number of at least `least`; else the inherited one, with a warning that says what was found.
double checked_scale(const ScaleSource& source, double found, double inherited,
                     std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
