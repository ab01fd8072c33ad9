// How prims and instancers move, as a host's values show it.
#pragma once

#include <pxr/imaging/hd/sceneDelegate.h>
#include <pxr/usd/sdf/path.h>

#include "delegate/hydra/timed_values.h"
#include "delegate/translate/frame/motions.h"

namespace msbvh::hydra {

using translate::MotionPointer;

// Of anything that moves while a host cannot say how far it turns: so many turns within the shutter are
// looked for at least (eight samples each). Faster ones may hide between them (docs/hydra.md).
inline constexpr double kAssumedTurns = 1.0;

translate::Matrix4d matrix_of(const GfMatrix4d& matrix);

// The transform of a prim over the shutter. A scene index evaluates it at any time; a scene delegate has
// samples of it, with lines between.
MotionPointer transform_motion(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter);
// The same of an instancer as a whole.
MotionPointer instancer_motion(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter);

// An instancer's own matrices, `hydra:instanceTransforms`: as many things as it has at the frame. Null where
// it has none.
MotionPointer instance_matrices(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter);

}  // namespace msbvh::hydra
