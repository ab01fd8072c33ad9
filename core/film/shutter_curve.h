// How a shutter opens and closes: how much light of each time counts, and when each row of the sensor is
// exposed.
//
// Times are drawn by the curve's inverse cumulative distribution, so that all samples count alike and keep
// the order of their well-spread numbers. Where the shutter is kept in slices the curve weights those instead
// (core/film/shutter_slices.h): samples stay where they are.
#pragma once

#include <cstdint>
#include <vector>

#include "core/film/piecewise_linear.h"

namespace msbvh {

// Places are times of the open shutter, in [0, 1]; the curve is 0 beyond the first and the last.
using ShutterCurve = std::vector<Knot>;

// Empty: open throughout, at once.
inline ShutterCurve box_curve() { return {}; }
inline ShutterCurve triangle_curve() { return {{0.0f, 0.0f}, {0.5f, 1.0f}, {1.0f, 0.0f}}; }
// Opens over the first quarter of its time and closes over the last.
inline ShutterCurve trapezoid_curve() { return {{0.0f, 0.0f}, {0.25f, 1.0f}, {0.75f, 1.0f}, {1.0f, 0.0f}}; }

// A sensor whose rows are read one after another, from the top: each is exposed for the shutter's time
// without `share` of it, and begins later by `share` of the shutter from the top edge of the picture to its
// bottom edge. 0: all rows at once; 1: each row sees one moment.
struct RollingShutter {
  float share = 0.0f;  // of the open shutter, in [0, 1]
  // What the rows rendered are of the picture's height: all of it, or a crop.
  float top = 0.0f, height = 1.0f;
};

class ShutterSampler {
 public:
  ShutterSampler() = default;
  // `curve`: empty, or a density over [0, 1].
  ShutterSampler(const ShutterCurve& curve, const RollingShutter& rolling)
      : times_(curve), rolling_(rolling) {}

  bool is_box() const { return times_.empty() && rolling_.share == 0.0f; }
  // `u` in [0, 1); `row` in [0, 1] from the top edge of the rows rendered. Below 1.
  float operator()(float u, float row) const {
    constexpr double kLast = 0x1.fffffep-1;
    double time = times_.empty() ? double(u) : times_.sample(double(u));
    const double share = rolling_.share;
    if (share > 0.0) time = share * (rolling_.top + double(row) * rolling_.height) + (1.0 - share) * time;
    return static_cast<float>(time < 0.0 ? 0.0 : time < kLast ? time : kLast);
  }

 private:
  PiecewiseLinear times_;
  RollingShutter rolling_;
};

}  // namespace msbvh
