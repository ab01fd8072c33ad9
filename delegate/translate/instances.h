// Instances of one prototype, by the million: each with the cheapest track that follows it, gathered by their
// tracks' form.
#pragma once

#include <optional>
#include <vector>

#include "core/base/box.h"
#include "core/base/vec.h"
#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/translator.h"
#include "delegate/translate/view_volume.h"

namespace msbvh::translate {

struct InstanceTarget {
  const ScreenMeasure& measure;
  Vec3d world_origin;      // of the frame, in stage space
  Vec3d prototype_origin;  // of the prototype's stored meshes, in its own space
  Box3d box;               // of the stored meshes, over the shutter
  FitSettings settings;
  std::uint32_t material_count = 0;
  const ViewVolume* view = nullptr;  // null: nothing counts as outside of the picture
  bool only_picture = false;         // what is outside is left out
  double outside_tolerance = 1.0;    // of what is outside, times that of the settings
};

struct TranslatedInstances {
  // By the cost of their tracks; instances in the order of the input.
  std::vector<InstanceSet> sets;
  // Of all together: the costliest and the largest error of any; or of each of the input's paths.
  std::vector<TrackReport> tracks;
  std::size_t left_out = 0;  // instances that no ray can reach
};

// Leaves out, with a warning that counts them: instances whose matrix is not finite, and those that are flat
// (singular, but not a line or a point, which cannot be seen) throughout the shutter. A singular key alone
// leaves nothing out. Empty for an input that cannot be used (an error in the log).
TranslatedInstances translate_instances(const InstancesInput& input, const InstanceTarget& target,
                                        PrimLog& log);

// Whether all instances are outside of the picture throughout the shutter; false where that is not certain.
bool outside_picture(const InstancesInput& input, const InstanceTarget& target);

// How many pixels a unit of the prototype's space covers at most, in any of the instances at any time.
double pixels_per_unit(const InstancesInput& input, const InstanceTarget& target);

}  // namespace msbvh::translate
