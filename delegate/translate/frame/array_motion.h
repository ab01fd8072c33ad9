// A point instancer's arrays as a motion: for lights, of which there are few. Meshes take the arrays as they
// are.
#pragma once

#include <memory>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/frame/placed_levels.h"

namespace msbvh::translate {

// Of the level's instances that count, by USD's rules for positions, orientations, scales and their rates
// (instance_chain.h). The level's own motion where it has one. Null, with an error in the log, for arrays
// that cannot be used.
MotionPointer motion_of(const PlacedLevel& level, PrimLog& log);

}  // namespace msbvh::translate
