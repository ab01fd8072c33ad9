// Levels of instancing as they move: sampled as densely as each of them needs, seen through those outside.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/box.h"
#include "delegate/translate/frame/motions.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Maps that stand side by side: a motion's things, or some of a point instancer's instances.
struct PlacedLevel {
  MotionPointer motion{};                               // null: arrays
  std::shared_ptr<const PointInstancerInput> arrays{};  // null: a motion
  std::vector<int> selected{};                          // the instances of the arrays that count

  std::size_t count() const { return motion ? motion->count() : selected.size(); }
};

// Pixels that a unit of a space covers at most, given the levels outside of it and a box in it.
using Measure = std::function<double(const std::vector<InstanceLevel>&, const Box3d&)>;

// Some of a placement's instances, which need as many samples.
struct SampledLevels {
  std::vector<InstanceLevel> levels;    // borrow from `storage` and from the input
  std::vector<std::int32_t> instances;  // of those of the placement, which of them these are
  std::vector<std::shared_ptr<const std::vector<Matrix4d>>> storage;
};

struct LevelSampling {
  Measure measure;
  double tolerance_pixels = 0.1;
};

// A few samples of a level: how large things are seen, not how they move.
class CoarseLevels {
 public:
  explicit CoarseLevels(std::span<const PlacedLevel> levels);

  // Of the levels from `first` on.
  std::vector<InstanceLevel> from(std::size_t first) const;

 private:
  std::vector<std::vector<Matrix4d>> storage_;
  std::vector<InstanceLevel> levels_;
};

// Around a box under all maps of a level, roughly: at a few times.
Box3d image_of(const PlacedLevel& level, const Box3d& box);

// The innermost level first; `box` is what they place. Several parts where some instances need more samples
// than others; those that a transform puts nowhere are left out, and counted.
struct LevelParts {
  std::vector<SampledLevels> parts;
  std::size_t unusable = 0;  // maps of single levels
};
LevelParts sample_levels(std::span<const PlacedLevel> levels, const Box3d& box, const LevelSampling& how);

}  // namespace msbvh::translate
