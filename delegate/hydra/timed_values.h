// A value with its times, as a host delivers it.
#pragma once

#include <optional>
#include <pxr/base/gf/matrix4d.h>
#include <pxr/base/vt/array.h>
#include <pxr/base/vt/value.h>
#include <pxr/imaging/hd/dataSource.h>
#include <pxr/imaging/hd/dataSourceTypeDefs.h>
#include <pxr/imaging/hd/enums.h>
#include <pxr/imaging/hd/sceneDelegate.h>
#include <utility>
#include <vector>

#include "delegate/hydra/api_version.h"
#include "delegate/translate/frame/frame_input.h"
#include "delegate/translate/frame/shutter.h"

namespace msbvh::hydra {

using translate::Shutter;

// Samples at increasing offsets from the frame, in frames. One where nothing changes over the shutter.
struct TimedValues {
  std::vector<float> offsets;
  std::vector<VtValue> values;
  std::vector<std::pair<float, VtIntArray>> indices;  // none, or at times of their own
  bool varies = false;                                // the host says so
  bool held = false;   // each sample holds until the next, as a host that evaluates shows
  VtValue at_frame{};  // evaluated there
  VtIntArray indices_at_frame{};

  bool empty() const { return values.empty(); }
};

// The scene index prim of a path in the render index's terminal scene index; none where the host runs without
// scene indices, and where there is no such prim.
HdContainerDataSourceHandle scene_index_prim(HdSceneDelegate& delegate, const SdfPath& path);

// Offsets at which a data source has samples that bear on the shutter, those next to it included. None where
// it is the same throughout.
std::vector<float> contributing_offsets(HdSampledDataSource& source, const Shutter& shutter);

TimedValues timed_values(const HdSampledDataSourceHandle& source, const Shutter& shutter);

// Integers over the shutter, each sample held until the next: at increasing time01. Empty where they stay the
// same.
using TimedInts = std::vector<std::pair<double, VtIntArray>>;
TimedInts timed_ints(const HdIntArrayDataSourceHandle& source, const Shutter& shutter);
// What begins at the closing or later says nothing, nor what ends before the opening.
bool changes_within(const HdIntArrayDataSourceHandle& source, const Shutter& shutter);
// Borrows.
translate::HeldIndices held_indices(const TimedInts& values);

// When a prim is visible: what its data source says over the shutter. Not given where it says nothing of its
// own, or stays the same: then the frame's counts.
translate::Visibility timed_visibility(HdSceneDelegate& delegate, const SdfPath& path,
                                       const Shutter& shutter);

// A primvar of a prim by its name; its indices where `indexed` and it has some. From the terminal scene index
// where there is one, else from the scene delegate.
TimedValues timed_primvar(HdSceneDelegate& delegate, const SdfPath& path, const TfToken& name,
                          const Shutter& shutter, bool indexed);

// Of computed points, such as UsdSkel's: what ExtComputations give over the shutter. Empty where no
// computation makes that primvar.
TimedValues timed_computation(HdSceneDelegate& delegate, const SdfPath& path, const TfToken& name,
                              const Shutter& shutter);

}  // namespace msbvh::hydra
