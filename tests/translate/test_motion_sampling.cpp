// Where and how densely motion is sampled (delegate/translate/sample), against closed forms.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "delegate/translate/sample/even_times.h"
#include "delegate/translate/sample/sampler.h"
#include "delegate/translate/smooth_times.h"
#include "delegate/translate/transform_samples.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

constexpr double kTolerance = 0.1;  // pixels
const Box3d kUnitBox{{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}};
const std::vector<Box3d> kBoxes{kUnitBox};
const PixelSize kPixel = PixelSize::uniform(0.01);

Matrix4d spun(double turns) {
  const double angle = 2.0 * std::numbers::pi * turns, c = std::cos(angle), s = std::sin(angle);
  return {c, s, 0.0, 0.0, -s, c, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0};
}

Matrix4d shifted(double x) {
  return {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0};
}

// Things whose matrices are functions of time.
class Functions : public MotionSource {
 public:
  using Function = std::function<Matrix4d(double)>;

  explicit Functions(std::vector<Function> functions, std::vector<double> breakpoints01 = {},
                     std::vector<Turns> turns = {})
      : functions_(std::move(functions)),
        breakpoints01_(std::move(breakpoints01)),
        turns_(std::move(turns)) {}

  std::size_t count() const override { return functions_.size(); }
  bool still() const override { return false; }
  std::vector<double> breakpoints01() const override { return breakpoints01_; }
  Turns turns(std::uint32_t which) const override { return turns_.empty() ? Turns() : turns_[which]; }
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override {
    for (std::size_t t = 0; t < times01.size(); ++t) {
      for (std::size_t i = 0; i < which.size(); ++i)
        out[t * which.size() + i] = functions_[which[i]](times01[t]);
    }
  }

 private:
  std::vector<Function> functions_;
  std::vector<double> breakpoints01_;
  std::vector<Turns> turns_;
};

// The farthest that a corner strays, in pixels, at times that no sampling meets.
double strays(const TransformSamples& samples, const Functions::Function& truth) {
  const TransformTrack track(samples);
  double most = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const double time01 = std::fmod(0.618034 * i, 1.0);
    const Affine3d found = track.at(time01), expected = affine_from(truth(time01));
    for (const Vec3d& corner : {kUnitBox.lo, kUnitBox.hi}) {
      most = std::max(most, length(found.point(corner) - expected.point(corner)) / kPixel.per_unit());
    }
  }
  return most;
}

}  // namespace

TEST_CASE("what moves along a line has the samples of its ends") {
  const Functions source({[](double u) { return shifted(5.0 * u); }});
  const std::vector<MotionSamples> found = sample_motion(source, kBoxes, kPixel, kTolerance, false);
  REQUIRE(found.size() == 1);
  CHECK(found[0].times01 == std::vector<double>{0.0, 1.0});
  CHECK(found[0].error_pixels < 1e-9);
}

TEST_CASE("turns are sampled until what is interpolated follows, whole turns too") {
  for (const double turns : {0.01, 0.3, 1.0, 4.0, 15.9, 64.0, 100.0}) {
    CAPTURE(turns);
    const auto spin = [turns](double u) { return spun(turns * u); };
    const Functions source({spin}, {}, {uniform_turns(turns)});
    const std::vector<MotionSamples> found = sample_motion(source, kBoxes, kPixel, kTolerance, false);
    REQUIRE(found.size() == 1);
    CHECK(double(found[0].times01.size()) > kTimesATurn * turns);
    CHECK(strays(found[0].of(0), spin) <= kSamplingShare * kTolerance);
    CHECK(found[0].error_pixels <= kSamplingShare * kTolerance);
  }
}

TEST_CASE("without a bound on its turns a whole turn passes for rest") {
  // Why turns() is asked for: nothing that is seen at these times tells the two apart.
  const auto spin = [](double u) { return spun(4096.0 * u); };
  const Functions source({spin}, {}, {uniform_turns(4096.0)});
  const std::vector<MotionSamples> found = sample_motion(source, kBoxes, kPixel, kTolerance, false);
  REQUIRE(found.size() == 1);
  CHECK(found[0].error_pixels >= 0.8 * 2.0 * std::sqrt(2.0) / kPixel.per_unit());
}

TEST_CASE("each thing has the samples that it needs") {
  const auto line = [](double u) { return shifted(u); };
  const auto spin = [](double u) { return spun(2.0 * u); };
  const Functions source({spin, line, spin}, {}, {uniform_turns(2.0), Turns(), uniform_turns(2.0)});
  std::vector<std::uint32_t> seen;
  for (const MotionSamples& samples : sample_motion(source, kBoxes, kPixel, kTolerance, false)) {
    seen.insert(seen.end(), samples.which.begin(), samples.which.end());
    for (std::size_t place = 0; place < samples.which.size(); ++place) {
      CHECK(strays(samples.of(place), samples.which[place] == 1 ? Functions::Function(line) : spin) <=
            kSamplingShare * kTolerance);
    }
    CHECK((samples.times01.size() == 2) == (samples.which.front() == 1));
  }
  std::ranges::sort(seen);
  CHECK(seen == std::vector<std::uint32_t>{0, 1, 2});
}

TEST_CASE("corners at breakpoints are met exactly, jumps are not bridged") {
  const double bend = 0.3;
  const auto bent = [bend](double u) { return shifted(u < bend ? u : bend - 3.0 * (u - bend)); };
  const std::vector<MotionSamples> at_bend =
      sample_motion(Functions({bent}, {bend}), kBoxes, kPixel, kTolerance, false);
  CHECK(at_bend[0].times01 == std::vector<double>{0.0, bend, 1.0});
  const double before = 0.3 - 4e-8;
  const auto jumps = [](double u) { return shifted(u < 0.3 ? 0.0 : 7.0); };
  const std::vector<MotionSamples> at_jump =
      sample_motion(Functions({jumps}, {before, 0.3}), kBoxes, kPixel, kTolerance, false);
  CHECK(at_jump[0].times01 == std::vector<double>{0.0, before, 0.3, 1.0});
}

TEST_CASE("values that hold are taken from the middle of what holds") {
  const auto steps = [](double u) { return shifted(u < 0.5 ? 1.0 : 2.0); };
  const std::vector<MotionSamples> found =
      sample_motion(Functions({steps}, {0.5}), kBoxes, kPixel, kTolerance, true);
  REQUIRE(found.size() == 1);
  CHECK(found[0].held);
  CHECK(found[0].times01 == std::vector<double>{0.0, 0.5});
  CHECK(found[0].matrices == std::vector<Matrix4d>{shifted(1.0), shifted(2.0)});
}

TEST_CASE("what is nowhere comes apart from the rest") {
  const auto line = [](double u) { return shifted(u); };
  const auto nan = [](double) { return shifted(NAN); };
  const auto huge = [](double u) { return shifted(u == 1.0 ? 0x1p61 : 0.0); };
  const Functions source({line, nan, huge});
  std::vector<std::uint32_t> usable, others;
  for (const MotionSamples& samples : sample_motion(source, kBoxes, kPixel, kTolerance, false)) {
    std::vector<std::uint32_t>& to = samples.usable ? usable : others;
    to.insert(to.end(), samples.which.begin(), samples.which.end());
  }
  CHECK(usable == std::vector<std::uint32_t>{0});
  CHECK(others == std::vector<std::uint32_t>{1, 2});
}

TEST_CASE("NaN inside of the shutter ends the search, and is reported as its error") {
  const auto source = Functions({[](double u) { return shifted(u > 0.2 && u < 0.8 ? NAN : u); }});
  const std::vector<MotionSamples> found = sample_motion(source, kBoxes, kPixel, kTolerance, false);
  REQUIRE(found.size() == 1);
  CHECK(std::isnan(found[0].error_pixels));
}

TEST_CASE("boxes are one, or one a thing") {
  const std::vector<Box3d> two(2, kUnitBox);
  const Functions three(std::vector<Functions::Function>(3, shifted));
  CHECK_THROWS_WITH_AS(sample_motion(three, two, kPixel, kTolerance, false),
                       "boxes: found 2; expected one, or one for each of 3 things", Error);
}

TEST_CASE("turns of a product add up, at the largest rate of each stretch") {
  const Turns slow = uniform_turns(2.0);
  const Turns burst({0.0, 0.5, 0.6, 1.0}, {0.0, 0.0, 1.0, 1.0});
  const Turns both = slow + burst;
  CHECK(both.total().back() == doctest::Approx(3.0));
  CHECK(both.rate() == doctest::Approx(12.0));
  const std::vector<double> ends{0.0, 0.5, 1.0};
  CHECK(both.within(ends)[0] == doctest::Approx(1.0));
  CHECK(both.within(ends)[1] == doctest::Approx(6.0));
  CHECK(both.periods01() == std::vector<double>{0.5});
  CHECK((Turns() + slow).rate() == slow.rate());
  CHECK(Turns().none());
  CHECK(uniform_turns(NAN).none());
  CHECK(uniform_turns(-1.0).none());
}

TEST_CASE("angles and orientations say how far they turn") {
  const std::vector<double> there_and_back{0.0, 720.0, 0.0};
  const Turns angles = angle_turns({0.0, 0.5, 1.0}, there_and_back, 1, {});
  CHECK(angles.total().back() == doctest::Approx(4.0));
  CHECK(angles.periods01().empty());
  const std::vector<double> even{0.0, 0.0, 360.0, -720.0, 1440.0, -2880.0};
  const Turns axes = angle_turns({0.0, 0.25, 1.0}, even, 2, {});
  CHECK(axes.total().back() == doctest::Approx(12.0));
  CHECK(axes.periods01() == std::vector<double>{1.0 / 8.0, 1.0 / 4.0});
  const std::vector<Quatd> quarter{{0.0, 0.0, 0.0, 2.0}, {0.0, 0.0, 3.0, 3.0}};
  CHECK(orientation_turns({0.0, 1.0}, quarter).total().back() == doctest::Approx(0.25));
}

TEST_CASE("a joint turns with all that it hangs on, wherever that stands in the order") {
  const auto about_x = [](double turns) {
    const double half = std::numbers::pi * turns;
    return Quatd{2.0 * std::sin(half), 0.0, 0.0, 2.0 * std::cos(half)};  // of any length
  };
  // Number 1 hangs on 2, which hangs on 0; the fastest is 1 in the first half, by 0.1 + 0.3 + 0.05, and 3 in
  // the second. The shorter way round from -0.3 to 0.4 is 0.3.
  const std::vector<int> parents{-1, 2, 0, -1};
  const std::vector<Quatd> rotations{about_x(0.0), about_x(0.0), about_x(0.0),  about_x(-0.3),
                                     about_x(0.1), about_x(0.3), about_x(0.05), about_x(-0.3),
                                     about_x(0.1), about_x(0.3), about_x(0.05), about_x(0.4)};
  const Turns turns = joint_turns({0.0, 0.5, 1.0}, rotations, parents);
  REQUIRE(turns.total().size() == 3);
  CHECK(turns.total()[1] == doctest::Approx(0.45));
  CHECK(turns.total()[2] == doctest::Approx(0.75));
}

TEST_CASE(
    "joints that turn nowhere, or by what is no number, have no turns; parents that are none are refused") {
  const Quatd rest{0.0, 0.0, 0.0, 1.0}, none{0.0, 0.0, 0.0, 0.0};
  const Quatd turned{1.0, 0.0, 0.0, 0.0}, bad{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0, 1.0};
  const std::vector<int> root{-1};
  CHECK(joint_turns({0.0, 1.0}, std::vector<Quatd>{rest, rest}, root).none());
  CHECK(joint_turns({0.0, 1.0}, std::vector<Quatd>{rest, bad}, root).none());
  CHECK(joint_turns({0.0, 1.0}, {}, {}).none());
  CHECK(joint_turns({0.0, 1.0}, std::vector<Quatd>{rest, turned}, root).rate() == doctest::Approx(0.5));
  CHECK(joint_turns({0.0, 1.0}, std::vector<Quatd>{rest, none}, root).rate() == doctest::Approx(0.5));
  const std::vector<Quatd> four(4, rest);
  for (const std::vector<int>& parents : {std::vector<int>{1, 0}, {0, -1}, {-1, 2}}) {
    CHECK_THROWS_AS(joint_turns({0.0, 1.0}, four, parents), Error);
  }
}

TEST_CASE("even times nest and leave room around breakpoints") {
  const std::vector<double> breakpoints{0.5 + 1e-12, 0.3, 0.3};
  const std::vector<double> coarse = even_times01(2, breakpoints), fine = even_times01(3, breakpoints);
  CHECK(coarse == std::vector<double>{0.0, 0.25, 0.3, 0.5 + 1e-12, 0.75, 1.0});
  CHECK(std::ranges::includes(fine, coarse));
  CHECK(even_times01(0, breakpoints, true) ==
        std::vector<double>{0.0, 0.3 - kBeforeJump01, 0.3, 0.5 + 1e-12 - kBeforeJump01, 0.5 + 1e-12, 1.0});
  CHECK(even_level(1.0) == 0);
  CHECK(even_level(9.0) == 4);
  CHECK(even_level(1e30) == kMostEvenLevel);
}

TEST_CASE("a pixel is as large as the nearest that it can be seen at") {
  const PixelSize pixel({{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, true, 0.01, 0.5);
  CHECK(pixel.at_box({{-1.0, -1.0, -12.0}, {1.0, 1.0, -10.0}}) == doctest::Approx(0.1));
  CHECK(pixel.at_box({{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}}) == doctest::Approx(0.005));
  CHECK(pixel.at_shell({0.0, 0.0, -10.0}, 2.0, 1.0) == doctest::Approx(0.08));
  CHECK(pixel.at_shell({0.0, 0.0, 0.0}, 101.0, 100.0) == doctest::Approx(0.99));
}
