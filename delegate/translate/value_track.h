// Values that shine or colour, and do not move: how samples over the shutter mix into the keys of a track.
// What they are (radiance, a million colours) is the caller's business.
//
// Samples are linear between their times. Two that lie within kJumpTime01 of each other make a jump, which is
// how a front-end hands down what holds and then changes at once (visibility, held stages). No track with
// finitely many keys follows a jump; averaged keys keep the integral over the shutter exactly, so that a
// light that is on for a hundredth of the shutter gives a hundredth of its light, and only when it does so is
// spread over a segment on either side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace msbvh::translate {

inline constexpr double kJumpTime01 = 2e-6;

// A weighted sum of samples; the weights sum to 1.
struct Share {
  std::size_t sample;
  double weight;
};
using Mix = std::vector<Share>;

// What the samples say at a time: held before the first and after the last.
Mix mix_at(std::span<const double> times01, double time01);

enum class Keys : std::uint8_t {
  kSampled,  // the value at the key's time
  kAveraged  // the mean about the key, weighted by its hat function
};

// key_count(segments) mixes.
std::vector<Mix> key_mixes(std::span<const double> times01, std::uint32_t segments, Keys keys);

// What a track of these keys has at a time beyond what the samples say: weights that sum to 0. Empty where
// they agree.
Mix track_minus_samples(const std::vector<Mix>& keys, std::span<const double> times01, double time01);

// How far a track strays from its samples, fed with their difference at increasing times that begin at 0. Of
// sampled keys the largest difference. Of averaged keys, which a jump spreads in time, the largest of the
// integrals from the shutter's opening: how much too early or too late light comes, in the difference's unit
// times the shutter.
class Deviation {
 public:
  explicit Deviation(Keys keys) : keys_(keys) {}
  void add(double time01, const Vec3d& difference);
  double largest() const { return largest_; }

 private:
  Keys keys_;
  double last_time01_ = 0.0;
  Vec3d last_, integral_;
  double largest_ = 0.0;
};

}  // namespace msbvh::translate
