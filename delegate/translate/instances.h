// Instances of one prototype, by the million: each with the cheapest track that follows it, gathered by their
// tracks' form.
#pragma once

#include <optional>
#include <vector>

#include "core/base/box.h"
#include "core/base/vec.h"
#include "core/scene/scene.h"
#include "delegate/translate/coarser_tally.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/material_table.h"
#include "delegate/translate/outside.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/translator.h"

namespace msbvh::translate {

struct InstanceTarget {
  const ScreenMeasure& measure;
  Vec3d world_origin;      // of the frame, in stage space
  Vec3d prototype_origin;  // of the prototype's stored meshes, in its own space
  Box3d box;               // of the stored meshes, over the shutter
  FitSettings settings;
  std::uint32_t material_count = 0;
  const Outside* outside = nullptr;          // null: one tolerance for all
  const MaterialTable* materials = nullptr;  // null: none reads a primvar
};

struct TranslatedInstances {
  // By the cost of their tracks; instances in the order of the input.
  std::vector<InstanceSet> sets;
  // Of all together: the costliest and the largest error of any; or of each of the input's paths.
  std::vector<TrackReport> tracks;
  // Of each set: what its members have in `tracks`.
  std::vector<std::vector<Saving>> savings;
};

// Leaves out, with a warning that counts them: instances whose matrix is not finite, and those that are flat
// (singular, but not a line or a point, which cannot be seen) throughout the shutter. A singular key alone
// leaves nothing out. Empty for an input that cannot be used (an error in the log).
TranslatedInstances translate_instances(const InstancesInput& input, const InstanceTarget& target,
                                        PrimLog& log);

// How many pixels a unit of the prototype's space covers at most, in any of the instances at any time.
double pixels_per_unit(const InstancesInput& input, const InstanceTarget& target);

}  // namespace msbvh::translate
