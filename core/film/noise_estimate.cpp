#include "core/film/noise_estimate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <sstream>

#include "core/base/error.h"
#include "core/film/sum_tree.h"

namespace msbvh {
namespace {

// What the mean of the square counts for beside a pixel's own numbers, of which there are two or three free
// ones.
constexpr double kOfSquare = 3.0;

FilmSum difference(const FilmSum& a, const FilmSum& b) {
  return {a.radiance - b.radiance, a.alpha - b.alpha};
}

double square(double x) { return x * x; }
double square(const Vec3d& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

}  // namespace

std::uint32_t NoiseGoal::least_samples() const { return std::max(2 * kBlockSamples, std::bit_ceil(min_spp)); }

void check(const NoiseGoal& goal) {
  if (goal.target >= 0.0f && goal.target <= kLargestNoiseTarget) return;
  std::ostringstream text;
  text << "render settings: noise: found " << goal.target << "; expected 0 (off) to " << kLargestNoiseTarget;
  throw Error(text.str());
}

void NoiseEstimate::reset(const NoiseGoal& goal, std::size_t pixels, double exposure) {
  goal_ = goal;
  darkest_ = kDarkest / exposure;
  run_ = goal.least_samples() / kMostRuns;
  count_ = 0;
  kept_ = 0;
  before_.assign(pixels, {});
  runs_.assign(pixels, {});
}

void NoiseEstimate::end_run(std::span<const FilmSum> sums) {
  const bool full = kept_ == kMostRuns;
  for (std::size_t pixel = 0; full && pixel < runs_.size(); ++pixel) {
    std::array<FilmSum, kMostRuns>& runs = runs_[pixel].sums;
    for (std::size_t i = 0; i < kMostRuns / 2; ++i) {
      runs[i] = runs[2 * i];
      runs[i] += runs[2 * i + 1];
    }
  }
  if (full) {
    run_ *= 2;
    kept_ = kMostRuns / 2;
  }
  for (std::size_t pixel = 0; pixel < runs_.size(); ++pixel) {
    runs_[pixel].sums[kept_] = difference(sums[pixel], before_[pixel]);
    before_[pixel] = sums[pixel];
  }
  ++kept_;
  count_ += run_;
}

bool NoiseEstimate::reached() const {
  return count_ >= goal_.least_samples() && largest_error() <= double(goal_.target);
}

double NoiseEstimate::relative_variance(std::size_t pixel) const {
  const double runs = double(kept_), scale = 1.0 / run_;
  const FilmSum& all = before_[pixel];
  const Vec3d mean = all.radiance * (1.0 / count_);
  const double alpha = all.alpha / count_;
  double of_radiance = 0.0, of_alpha = 0.0;
  for (std::size_t i = 0; i < kept_; ++i) {
    const FilmSum& run = runs_[pixel].sums[i];
    of_radiance += square(run.radiance * scale - mean);
    of_alpha += square(run.alpha * scale - alpha);
  }
  const double of_mean = 1.0 / (runs * (runs - 1.0));
  const double level = std::max(darkest_, (mean.x + mean.y + mean.z) / 3.0);
  return of_mean * std::max(of_radiance / 3.0 / square(level), of_alpha);
}

double NoiseEstimate::largest_error() const {
  double sum = 0.0, largest = 0.0;
  for (std::size_t pixel = 0; pixel < runs_.size(); ++pixel) {
    const double own = relative_variance(pixel);
    sum += own;
    largest = std::max(largest, own);
  }
  const double free = double(kept_) - 1.0, mean = sum / double(runs_.size());
  return std::sqrt((free * largest + kOfSquare * mean) / (free + kOfSquare));
}

}  // namespace msbvh
