#include "delegate/translate/value_track.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/motion/track.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {
namespace {

// The hat function of a key: 1 at its time, 0 at its neighbours' and beyond; the only key's is 1 everywhere.
double hat(double time01, std::uint32_t key, std::uint32_t segments) {
  return segments == 0 ? 1.0 : std::max(0.0, 1.0 - std::abs(time01 * segments - key));
}

// The integral of the samples times a hat function, over the hat function's own. Both are linear between
// knots, so that Simpson's rule is exact.
class HatAverage {
 public:
  explicit HatAverage(std::size_t sample_count) : weights_(sample_count, 0.0) {}

  void add(std::span<const double> times01, double time01, double weight) {
    total_ += weight;
    for (const Share& share : mix_at(times01, time01)) weights_[share.sample] += weight * share.weight;
  }
  Mix finish() const {
    Mix mix;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (weights_[i] != 0.0) mix.push_back({i, weights_[i] / total_});
    }
    return mix;
  }

 private:
  std::vector<double> weights_;
  double total_ = 0.0;
};

Mix averaged(std::span<const double> times01, std::span<const double> knots01, std::uint32_t key,
             std::uint32_t segments) {
  HatAverage average(times01.size());
  for (std::size_t i = 1; i < knots01.size(); ++i) {
    const double begin = knots01[i - 1], end = knots01[i], middle = 0.5 * (begin + end);
    if (hat(middle, key, segments) == 0.0) continue;
    const double sixth = (end - begin) / 6.0;
    average.add(times01, begin, sixth * hat(begin, key, segments));
    average.add(times01, middle, 4.0 * sixth * hat(middle, key, segments));
    average.add(times01, end, sixth * hat(end, key, segments));
  }
  return average.finish();
}

}  // namespace

Mix mix_at(std::span<const double> times01, double time01) {
  const Bracket at = bracket(times01, time01);
  if (at.first == at.second || at.w == 0.0) return {{at.first, 1.0}};
  return {{at.first, 1.0 - at.w}, {at.second, at.w}};
}

std::vector<Mix> key_mixes(std::span<const double> times01, std::uint32_t segments, Keys keys) {
  const std::vector<double> knots01 = knots(times01, segments);
  std::vector<Mix> mixes;
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    mixes.push_back(keys == Keys::kAveraged ? averaged(times01, knots01, key, segments)
                                            : mix_at(times01, key_time(key, segments)));
  }
  return mixes;
}

Mix track_minus_samples(const std::vector<Mix>& keys, std::span<const double> times01, double time01) {
  constexpr double kRounding = 1e-12;
  std::vector<double> weights(times01.size(), 0.0);
  const auto segments = std::uint32_t(keys.size() - 1);
  const TrackTime at = locate_key(time01, segments);
  for (const Share& share : keys[at.key]) weights[share.sample] += (1.0 - at.w) * share.weight;
  for (const Share& share : keys[std::min(at.key + 1, segments)])
    weights[share.sample] += at.w * share.weight;
  for (const Share& share : mix_at(times01, time01)) weights[share.sample] -= share.weight;
  Mix difference;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (std::abs(weights[i]) > kRounding) difference.push_back({i, weights[i]});
  }
  return difference;
}

void Deviation::add(double time01, const Vec3d& difference) {
  assert(time01 >= last_time01_);
  integral_ += (last_ + difference) * (0.5 * (time01 - last_time01_));
  last_time01_ = time01;
  last_ = difference;
  largest_ = std::max(largest_, length(keys_ == Keys::kSampled ? difference : integral_));
}

}  // namespace msbvh::translate
