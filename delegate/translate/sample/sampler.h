// How densely transforms are sampled over the shutter: as interpolation between the samples needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/box.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/sample/motion_source.h"
#include "delegate/translate/sample/pixel_size.h"

namespace msbvh::translate {

// Of the tolerance: by how much interpolation between samples may stray from the stage. The rest is the
// track's.
inline constexpr double kSamplingShare = 0.1;
// The largest element of a usable matrix, so that products do not overflow.
inline constexpr double kLargestElement = 0x1p60;

// Some of a motion's things over the shutter.
struct MotionSamples {
  std::vector<std::uint32_t> which;  // of the motion's things
  std::vector<double> times01;
  std::vector<Matrix4d> matrices;  // [time][which]
  std::vector<double> breakpoints01;
  bool held = false;
  double error_pixels = 0.0;  // by which interpolation between the samples may stray from the stage
  // Of each thing, after which its motion may repeat, as shares of the shutter; empty where none does.
  std::vector<std::vector<double>> periods01;
  // Where false, a matrix of each thing is not finite or too large: nothing can be drawn there.
  bool usable = true;

  TransformSamples of(std::size_t place) const;
};

// Samples matrices until what is interpolated between them follows the stage within a share of the tolerance,
// halving the stretches between breakpoints for those things that need it. Every thing comes once. `boxes`
// are those of the things, each in its own space; one: of each. `held`: values jump from sample to sample.
std::vector<MotionSamples> sample_motion(const MotionSource& source, std::span<const Box3d> boxes,
                                         const PixelSize& pixel_size, double tolerance_pixels, bool held);

}  // namespace msbvh::translate
