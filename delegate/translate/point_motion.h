// Which of USD's rules says how the points of a mesh move, and the motion by it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delegate/translate/array_samples.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

struct PointMotion {
  ArrayTrack track;
  std::string source;  // points, velocities, accelerations
  std::string rule;    // in words
  // Normals and other values that belong to the points come from the frame alone: the points are carried from
  // a base sample, or held.
  bool frame_only = false;
  // Of `frame_only`: the values at the frame, where they are not those of a sample.
  std::shared_ptr<const std::vector<Vec3f>> held{};
};

// Velocities where they apply (rates.h), else the samples; the pose of the frame, with a warning, where the
// topology changes and no velocities say how to go on. Nothing, with an error in the log, for points that
// cannot be used.
std::optional<PointMotion> point_motion(const MeshInput& input, PrimLog& log);

}  // namespace msbvh::translate
