// What is back where it was at every even time of the shutter is not at rest: normals, and time remaps that
// repeat.
#include <cmath>
#include <doctest/doctest.h>
#include <vector>

#include "core/base/lerp.h"
#include "core/motion/time_remap.h"
#include "delegate/translate/moving_array.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

constexpr double kTolerance = 0.01;  // radians
// Met by no period.
double random_time01(int i) { return std::fmod((i + 0.5) * std::numbers::phi, 1.0); }

MovingArray turning_normal(double turns, const Vec3f& normal) {
  const int samples = int(std::ceil(16.0 * turns)) + 1;
  const auto motion = [turns](double time01) { return rotation(360.0 * turns * time01); };
  const ArraySamples still{{{0.0, {&normal, 1}}}, false, true};
  return {ArrayTrack(still), TransformTrack(sampled(motion, uniform_times(samples)))};
}

}  // namespace

TEST_SUITE("translate: whole turns") {
  TEST_CASE("normals on linear keys follow any number of whole turns") {
    const Vec3f normal{1, 0, 0};
    for (const double turns : {1.0, 4.0, 7.75, 8.0}) {
      CAPTURE(turns);
      const MovingArray normals = turning_normal(turns, normal);
      const TimeLayout layout = TimeLayout::even(1);
      const Fit fit = fit_normals(normals, layout, {kTolerance, 128});
      REQUIRE(fit.segments > 0);
      CHECK(fit.error <= kTolerance);
      const std::vector<Vec3f> keys = normal_keys(normals, layout, fit.segments);
      double worst = 0.0;
      for (int i = 0; i < 500; ++i) {
        const double place = random_time01(i) * fit.segments;
        const auto key = std::size_t(place);
        const Vec3d found = normalize(lerp(Vec3d(keys[key]), Vec3d(keys[key + 1]), place - double(key)));
        worst = std::max(worst, length(found - rotation(360.0 * turns * random_time01(i)).x));
      }
      CHECK(worst <=
            1.25 * kTolerance);  // tests lie a sixteenth of a turn apart, the samples' own chords on top
    }
  }

  TEST_CASE("a time remap that repeats runs through one period after the other") {
    for (const double turns : {2.0, 3.99, 4.0, 99.75, 100.0}) {
      CAPTURE(turns);
      const TimeLayout layout = TimeLayout::repeating(1.0 / turns, 3);
      CHECK(layout.segments() == 8);
      const TimeRemap time_remap = layout.time_remap();
      REQUIRE(is_valid_time_remap(time_remap));
      CHECK(time_remap.pieces.size() == std::size_t(std::ceil(turns)));
      for (int i = 0; i < 1000; ++i) {
        const auto u = float(random_time01(i));
        float local = -1.0f;
        REQUIRE(time_remap.at(u, local));
        const double turned = double(u) * turns, truth = turned - std::floor(turned);
        const double apart = std::abs(local - truth);
        CHECK(std::min(apart, 1.0 - apart) <= turns * 0x1p-23);  // single precision of a piece's beginning
      }
    }
  }
}
