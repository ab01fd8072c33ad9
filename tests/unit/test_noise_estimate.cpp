// core/film/noise_estimate.h: which runs samples come in, and what they say.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/film/noise_estimate.h"
#include "core/film/sum_tree.h"

namespace msbvh {
namespace {

// Of grey pixels that are seen through by a share.
class Pixels {
 public:
  Pixels(const NoiseGoal& goal, std::size_t count) : sums_(count) { estimate.reset(goal, count); }

  // The next run, in which pixels have those means.
  void run(const std::vector<double>& values, double alpha = 1.0) {
    const double samples = estimate.next_run();
    taken += estimate.next_run();
    for (std::size_t i = 0; i < sums_.size(); ++i)
      sums_[i] += FilmSum{Vec3d(values[i], values[i], values[i]) * samples, alpha * samples};
    estimate.end_run(sums_);
  }

  NoiseEstimate estimate;
  std::uint32_t taken = 0;

 private:
  std::vector<FilmSum> sums_;
};

TEST_CASE("noise is judged at 2^k and 3 * 2^k samples, whole blocks, from the least on") {
  for (const std::uint32_t least : {1u, 32u, 33u, 100u}) {
    const NoiseGoal goal{0.1f, least};
    Pixels pixels(goal, 1);
    std::uint32_t wanted = goal.least_samples();
    CHECK(wanted >= least);
    for (int step = 0; step < 12; ++step) {
      while (pixels.taken < wanted) {
        if (pixels.taken < goal.least_samples()) CHECK_FALSE(pixels.estimate.reached());
        pixels.run({1.0});
      }
      CHECK(pixels.taken == wanted);
      CHECK(pixels.estimate.reached());
      CHECK(wanted % kBlockSamples == 0);
      wanted = step % 2 == 0 ? wanted / 2 * 3 : wanted / 3 * 4;
    }
  }
}

TEST_CASE("the error is that of the mean of the runs, as a share of the value") {
  Pixels pixels({0.1f, 32}, 1);
  for (const double value : {1.0, 3.0, 2.0, 2.0}) pixels.run({value});
  // Variance of the runs 2 / 3, of their mean a fourth of it.
  CHECK(pixels.estimate.largest_error() == doctest::Approx(std::sqrt(2.0 / 3.0 / 4.0) / 2.0));
  pixels.run({2.0});  // of 16 samples: runs are now 2, 2, 2
  CHECK(pixels.estimate.largest_error() == doctest::Approx(0.0));
  pixels.run({2.4});
  CHECK(pixels.estimate.largest_error() == doctest::Approx(0.1 / 2.1));
}

TEST_CASE("the dark is held to the error of what is a little brighter; alpha counts as it is") {
  Pixels dark({0.1f, 32}, 1), edge({0.1f, 32}, 1);
  for (const double value : {0.0, 0.002, 0.001, 0.001}) dark.run({value});
  CHECK(dark.estimate.largest_error() == doctest::Approx(std::sqrt(2e-6 / 3.0 / 4.0) / kDarkest));
  for (const double alpha : {0.0, 1.0, 0.5, 0.5}) edge.run({0.0}, alpha);
  CHECK(edge.estimate.largest_error() == doctest::Approx(std::sqrt(0.5 / 3.0 / 4.0)));
}

TEST_CASE("one noisy pixel among quiet ones counts, and more where its neighbours are noisy too") {
  const auto error = [](double others) {
    Pixels pixels({0.1f, 32}, 16);
    for (const double value : {0.5, 1.5, 0.5, 1.5}) {
      std::vector<double> values(16, 1.0 + (value - 1.0) * others);
      values[5] = value;
      pixels.run(values);
    }
    return pixels.estimate.largest_error();
  };
  const double own = std::sqrt(1.0 / 3.0 / 4.0);
  CHECK(error(1.0) == doctest::Approx(own));
  CHECK(error(0.0) > 0.7 * own);
  CHECK(error(0.0) < error(0.5));
}

TEST_CASE("goals that make no sense are refused by name") {
  for (const float target :
       {-0.1f, 1.5f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    CAPTURE(target);
    CHECK_THROWS_WITH_AS(check(NoiseGoal{target, 32}), doctest::Contains("noise: found"), Error);
  }
  CHECK_NOTHROW(check(NoiseGoal{}));
}

}  // namespace
}  // namespace msbvh
