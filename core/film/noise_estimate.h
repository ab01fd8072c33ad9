// How noisy the pixels of a small square are, by their own samples.
//
// A pixel's samples are taken in runs of equal length, one after another, of which three or four are kept:
// where there are four, the first two and the last two become one run each before the next is taken. Each is
// an aligned 2^k samples, a well-distributed point set like the whole. How far the means of the runs lie
// apart says how far the mean of all lies from the truth, with what the points are better by than independent
// ones, which the spread of the samples does not know. (Points gain by their number: the whole is closer to
// the truth than the estimate says, never further by more than chance.)
//
// Three or four numbers say little of one pixel, so each is judged together with its neighbours in the
// square. Nothing beyond the square enters, and nothing but samples of whole runs.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/film/film_sample.h"
#include "core/film/noise_goal.h"

namespace msbvh {

// Pixels along the edge of those that are judged together, and have the same number of samples.
inline constexpr std::uint32_t kNoiseSquare = 4;
// Of linear light in the picture. Where a pixel is darker, its error is held against this: what is 5 % of
// black would never end.
inline constexpr double kDarkest = 0.05;

class NoiseEstimate {
 public:
  // `exposure`: what the sums are multiplied by in the picture.
  void reset(const NoiseGoal& goal, std::size_t pixels, double exposure = 1.0);

  // Of each pixel, that end_run() has been told of.
  std::uint32_t samples() const { return count_; }
  // How many samples of each pixel come next.
  std::uint32_t next_run() const { return kept() == kMostRuns ? 2 * run_ : run_; }
  // Those have been taken. `sums`: of all samples of each pixel until now.
  void end_run(std::span<const FilmSum> sums);
  // Whether no pixel is noisier than the goal; false before there are enough samples to tell.
  bool reached() const;
  // The noisiest pixel's error, in the goal's units.
  double largest_error() const;

 private:
  static constexpr std::size_t kMostRuns = 4;
  struct Runs {
    std::array<FilmSum, kMostRuns> sums;
  };

  std::size_t kept() const { return kept_; }
  double relative_variance(std::size_t pixel) const;

  NoiseGoal goal_;
  double darkest_ = kDarkest;          // of the sums' light
  std::uint32_t run_ = 0, count_ = 0;  // samples of a run, and of all
  std::size_t kept_ = 0;
  std::vector<FilmSum> before_;  // sums at the end of the last run
  std::vector<Runs> runs_;       // by pixel
};

}  // namespace msbvh
