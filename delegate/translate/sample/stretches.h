// The stretches of the shutter between breakpoints, each split evenly into 2^split, and interpolation in them
// as the translator does it (smooth_times.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace msbvh::translate {

// The corners of things' boxes over time, in the world: [time][thing][8].
struct CornerSamples {
  std::size_t things = 0;
  std::vector<Vec3d> points;

  std::size_t times() const { return things == 0 ? 0 : points.size() / (8 * things); }
  const Vec3d& at(std::size_t time, std::size_t thing, std::size_t corner) const {
    return points[(time * things + thing) * 8 + corner];
  }
};

class Stretches {
 public:
  // From here on a stretch has the four samples that a cubic takes; lines before.
  static constexpr int kCubicSplit = 2;

  // Breakpoints may be anywhere. Those that differ by rounding alone, or lie at the shutter's ends, are one:
  // a stretch of no length cannot be halved.
  explicit Stretches(std::span<const double> breakpoints01);

  // 0, the breakpoints inside, 1.
  std::span<const double> ends01() const { return ends01_; }
  std::size_t count() const { return ends01_.size() - 1; }
  // Not a jump, across which nothing lies.
  bool is_long(std::size_t stretch) const;
  std::size_t parts(std::size_t stretch, int split) const;
  // Of all stretches, increasing from 0 to 1.
  std::vector<double> times01(int split) const;
  // Which of times01(split + 1) are among times01(split).
  std::vector<bool> kept(int split) const;
  // Between samples of each stretch, off the places where what is no turn and yet repeats might hide.
  std::vector<double> probes01() const;

  // How far each thing's corners at probes stray at most from what is interpolated between those at
  // times01(split). Since corners are linear in the matrices, this bounds every point of a box.
  std::vector<double> strays(int split, const CornerSamples& samples, std::span<const double> probes01,
                             const CornerSamples& probed) const;

 private:
  std::vector<double> ends01_;
};

// `value` or what was there, whichever is larger; NaN stays.
void raise_to(double& most, double value);

}  // namespace msbvh::translate
