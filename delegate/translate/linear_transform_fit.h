// Linear tracks of one affine map, on even keys: for lights, of which there are few.
#pragma once

#include <vector>

#include "core/base/affine.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {

// The samples and a track are both linear by element between knots, so that their difference over a box is
// largest at a corner of the box and at a sample time (at the keys it is zero): testing there is exhaustive.
class LinearTransformFitter {
 public:
  // `maps` take the box to the measure's world. Borrows both.
  LinearTransformFitter(const TransformTrack& maps, const ScreenMeasure& measure,
                        const FitSettings& settings);

  // Error in pixels.
  Fit fit(const BoxCorners& box) const;
  // The track's keys, key_count(segments) of them.
  void keys(std::uint32_t segments, Affine3f* keys) const;

 private:
  struct Test {
    double time01;
    ScreenInstant screen;
  };
  Affine3d track(double time01, std::uint32_t segments) const;
  double error(const BoxCorners& box, std::uint32_t segments, double limit) const;

  const TransformTrack& maps_;
  std::vector<Test> tests_;
  FitSettings settings_;
};

}  // namespace msbvh::translate
