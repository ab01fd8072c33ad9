// Tracks of affine maps: how few keys a moving object, instance or light needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/affine.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {

// Fits maps that share their sample times: one object or a million instances. Thread-safe.
//
// The samples and a track are both linear by element between knots, so that their difference over a box is
// largest at a corner of the box and at a sample time (at the keys it is zero): testing there is exhaustive.
class TransformFitter {
 public:
  // `times01`: of the samples that the shutter sees.
  TransformFitter(std::span<const double> times01, const ScreenMeasure& measure, const FitSettings& settings);

  // `maps`, one a sample time, take the box to the measure's world. Error in pixels.
  Fit fit(std::span<const Affine3d> maps, const BoxCorners& box) const;
  // The track's keys, key_count(segments) of them.
  void keys(std::span<const Affine3d> maps, std::uint32_t segments, Affine3f* keys) const;

 private:
  struct Test {
    double time01;
    ScreenInstant screen;
  };
  Affine3d sample(std::span<const Affine3d> maps, double time01) const;
  Affine3d track(std::span<const Affine3d> maps, double time01, std::uint32_t segments) const;
  double error(std::span<const Affine3d> maps, const BoxCorners& box, std::uint32_t segments,
               double limit) const;

  std::vector<double> times01_;
  std::vector<Test> tests_;
  FitSettings settings_;
};

}  // namespace msbvh::translate
