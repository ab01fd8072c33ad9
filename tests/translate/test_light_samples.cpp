// What a light gives over the shutter (delegate/translate/look), and when its values are read
// (delegate/translate/sample), against hand-worked cases.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "delegate/translate/look/light_samples.h"
#include "delegate/translate/sample/even_times.h"
#include "delegate/translate/sample/value_times.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

using Times = std::vector<double>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kEvenTimes = (std::size_t(1) << kFinestLevel) + 1;

// Lights that move together; the translation of number i is i along y.
class Places : public MotionSource {
 public:
  using Scale = std::function<double(double)>;

  explicit Places(Scale scale = {}, double turns = 0.0, std::size_t count = 1)
      : scale_(std::move(scale)), turns_(turns), count_(count) {}

  std::size_t count() const override { return count_; }
  bool still() const override { return !scale_; }
  Times breakpoints01() const override { return {}; }
  Turns turns(std::uint32_t which) const override { return uniform_turns(which * turns_); }
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override {
    for (std::size_t t = 0; t < times01.size(); ++t) {
      for (std::size_t i = 0; i < which.size(); ++i) {
        const double s = scale_ ? scale_(times01[t]) : 1.0;
        out[t * which.size() + i] = {s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, 0, double(which[i]), 0, 1};
      }
    }
  }

 private:
  Scale scale_;
  double turns_;
  std::size_t count_;
};

LightSamples samples_at(const Times& times01, const std::function<double(double)>& emission,
                        const LightNumbers& sizes = {}, bool normalize = false) {
  LightSamples samples{times01, {}, {}, {}};
  for (const double time01 : times01) {
    samples.emission.push_back(Vec3d{1.0, 0.5, 0.0} * emission(time01));
    samples.numbers.push_back(sizes);
    samples.normalize.push_back(normalize);
  }
  return samples;
}

double one(double) { return 1.0; }

LightSwitches never_off(std::size_t times) { return {std::vector<bool>(times, true)}; }

SampledLight changing(const std::function<double(double)>& emission, const LightNumbers& sizes = {},
                      bool normalize = false) {
  const Times times01{0.0, 0.25, 0.5, 1.0};
  return {samples_at({0.0}, emission, sizes, normalize), samples_at(times01, emission, sizes, normalize),
          never_off(times01.size())};
}

const ValueTime* find(const std::vector<ValueTime>& times, double time01) {
  const auto found = std::ranges::find(times, time01, &ValueTime::time01);
  return found == times.end() ? nullptr : &*found;
}

LightInput placed(LightKind kind, const SampledLight& light, const Places& places) {
  return placed_light(kind, light, places, 0, light_times01(places, false), 0.5);
}

}  // namespace

TEST_CASE("values are read at even times, and the closing an instant before it") {
  const std::vector<ValueTime> times = value_times({}, {});
  REQUIRE(times.size() == kEvenTimes);
  for (std::size_t i = 0; i < kEvenTimes; ++i) {
    CHECK(times[i].time01 == double(i) / double(kEvenTimes - 1));
    CHECK(times[i].read_at01 == (i + 1 < kEvenTimes ? times[i].time01 : 1.0 - kBeforeJump01));
    CHECK_FALSE(times[i].authored);
  }
}

TEST_CASE("values are read at authored times and switches, and an instant before each") {
  const Times authored01{0.7, 0.3}, switched01{0.9};
  const std::vector<ValueTime> times = value_times(authored01, switched01);
  CHECK(times.size() == kEvenTimes + 6);
  CHECK(std::ranges::is_sorted(times, std::less_equal<>(), &ValueTime::time01));
  REQUIRE(find(times, 0.3));
  CHECK(find(times, 0.3)->authored == 1);
  REQUIRE(find(times, 0.7));
  CHECK(find(times, 0.7)->authored == 0);
  REQUIRE(find(times, 0.9));
  CHECK_FALSE(find(times, 0.9)->authored);
  for (const double time01 : {0.3, 0.7, 0.9}) {
    REQUIRE(find(times, time01 - kBeforeJump01));
    CHECK(find(times, time01 - kBeforeJump01)->read_at01 == time01 - kBeforeJump01);
  }
}

TEST_CASE("a switch at an authored time is read at the time that is authored") {
  const Times both01{0.3};
  const std::vector<ValueTime> times = value_times(both01, both01);
  CHECK(times.size() == kEvenTimes + 2);
  REQUIRE(find(times, 0.3));
  CHECK(find(times, 0.3)->authored == 0);
}

TEST_CASE("an authored time takes the place of the even one that differs by rounding") {
  const double beside = 0.5 + 1e-12;
  const std::vector<ValueTime> times = value_times(Times{0.0, beside}, {});
  CHECK(times.size() == kEvenTimes + 1);
  CHECK_FALSE(find(times, 0.5));
  REQUIRE(find(times, beside));
  CHECK(find(times, beside)->authored == 1);
  CHECK(times.front().authored == 0);  // with no instant before it
}

TEST_CASE("what begins with the closing is not seen") {
  const std::vector<ValueTime> times = value_times(Times{1.0, 1.0 - 0.5 * kBeforeJump01}, Times{1.0});
  CHECK(times.size() == kEvenTimes);
  CHECK_FALSE(times.back().authored);
}

TEST_CASE("values that are all the same are one") {
  CHECK(changing(one).over_shutter().still());
  CHECK_FALSE(changing([](double u) { return u; }).over_shutter().still());
  const Times ends{0.0, 1.0};
  LightSamples wider = samples_at(ends, one), normalized = wider, none = wider;
  wider.numbers[1].width = 2.0;
  normalized.normalize[1] = true;
  none.emission[0].x = none.emission[1].x = kNaN;
  for (const LightSamples& samples : {wider, normalized, none}) {
    CHECK_FALSE(SampledLight(samples_at({0.0}, one), samples, never_off(2)).over_shutter().still());
  }
}

TEST_CASE("a light is off while it is invisible, or its instances are") {
  const LightSwitches switches{{true, true, true, false},
                               std::vector<VisibleInterval>{{0.25, 0.5}, {0.75, 2.0}}};
  const SampledLight light(samples_at({0.0}, one), samples_at({0.0, 0.25, 0.5, 1.0}, one), switches);
  CHECK(light.at_frame().emission[0].x == 1.0);
  Times found;
  for (const Vec3d& emission : light.over_shutter().emission) found.push_back(emission.x);
  CHECK(found == Times{0.0, 1.0, 0.0, 0.0});
  CHECK(switches.on(0, 0.75));
  CHECK(switch_times01(*switches.shown) == Times{0.25, 0.5, 0.75});
}

TEST_CASE("a size that passes zero stays an extent; one that is zero throughout stays zero") {
  LightSamples samples = samples_at({0.0, 0.5, 1.0}, one, {0.53, 0.0, 1.0, 0.0});
  samples.numbers[1].radius = 2.0;
  samples.numbers[2].width = 0.0;
  const SampledLight light(samples_at({0.0}, one), samples, never_off(3));
  const std::vector<LightNumbers>& sizes = light.over_shutter().numbers;
  CHECK(sizes[0].radius == kSmallestShare * 2.0);
  CHECK(sizes[1].radius == 2.0);
  CHECK(sizes[2].width == kSmallestShare);
  CHECK(sizes[0].height == 0.0);
  CHECK(sizes[2].angle_degrees == 0.53);
}

TEST_CASE("a frame whose values are no numbers takes those of the opening") {
  LightSamples at_frame = samples_at({0.0}, one);
  at_frame.numbers[0].radius = kNaN;
  const SampledLight light(at_frame, samples_at({0.0, 1.0}, [](double u) { return 3.0 + u; }), never_off(2));
  CHECK(light.at_frame().still());
  CHECK(light.at_frame().emission[0].x == 3.0);
  CHECK(light.at_frame().numbers[0].radius == 0.5);
  CHECK(std::isnan(SampledLight(at_frame).at_frame().numbers[0].radius));  // nothing else is known
}

TEST_CASE("numbers of values that do not agree are refused") {
  LightSamples fewer = samples_at({0.0, 1.0}, one);
  fewer.numbers.pop_back();
  CHECK_THROWS_AS(SampledLight(samples_at({0.0}, one), fewer, never_off(2)), Error);
  CHECK_THROWS_AS(SampledLight(samples_at({0.0}, one), samples_at({0.0, 1.0}, one), never_off(1)), Error);
  CHECK_THROWS_AS(SampledLight(samples_at({}, one)), Error);
  CHECK_THROWS_AS(SampledLight(samples_at({0.0, 1.0}, one)), Error);
}

TEST_CASE("a still light has no samples, of values nor of places") {
  const LightInput input = placed(LightKind::kSphere, SampledLight(samples_at({0.0}, one)), Places());
  CHECK(input.values.empty());
  CHECK(input.world_from_light.times01 == Times{0.0});
  CHECK(input.light.radiance.y == 0.5f);
  const auto stays = [](double) { return 2.0; };
  const SampledLight light(samples_at({0.0}, one, {}, true));
  CHECK(placed(LightKind::kSphere, light, Places(stays)).values.empty());
  CHECK(placed(LightKind::kSphere, light, Places(stays)).world_from_light.matrices.size() == 1);
}

TEST_CASE("a light that changes has its own values at the frame and samples over the shutter") {
  const LightInput input = placed(LightKind::kSphere, changing([](double u) { return 1.0 + u; }), Places());
  CHECK(input.light.radiance.x == 1.0f);
  REQUIRE(input.values.size() == 4);
  CHECK(input.values_times01 == Times{0.0, 0.25, 0.5, 1.0});
  CHECK(input.values[1].radiance.x == 1.25f);
  CHECK(input.values[3].radiance.y == 1.0f);
}

TEST_CASE("a normalised light that scales keeps its power, where it changes and where it does not") {
  const auto scale = [](double u) { return 1.0 + u; };
  const LightNumbers sizes{0.53, 0.5, 2.0, 3.0};
  const SampledLight still(samples_at({0.0}, one, sizes, true));
  for (const SampledLight& light : {still, changing([](double u) { return 1.0 + u; }, sizes, true)}) {
    const LightInput input = placed(LightKind::kRect, light, Places(scale));
    REQUIRE(input.values.size() == (light.over_shutter().still() ? kEvenTimes : 4));
    for (std::size_t i = 0; i < input.values.size(); ++i) {
      const double u = input.values_times01[i], emitted = light.over_shutter().still() ? 1.0 : 1.0 + u;
      CHECK(input.values[i].radiance.x == doctest::Approx(emitted / (6.0 * scale(u) * scale(u))));
    }
    // At the frame, where the transform is that of 0.5.
    CHECK(input.light.radiance.x == doctest::Approx(1.0 / (6.0 * 2.25)));
  }
  // Of what is not normalised the transform says nothing.
  CHECK(placed(LightKind::kRect, SampledLight(samples_at({0.0}, one, sizes)), Places(scale)).values.empty());
}

TEST_CASE("changes that leave radiance and sizes as they are leave the light still") {
  LightSamples samples = samples_at({0.0, 1.0}, one);  // of a rectangle whose area is 1
  samples.normalize[1] = true;
  const SampledLight light(samples_at({0.0}, one), samples, never_off(2));
  CHECK(placed(LightKind::kRect, light, Places()).values.empty());
  CHECK(placed(LightKind::kSphere, light, Places()).values.size() == 2);  // pi, not 1
}

TEST_CASE("the fastest of lights that move together says how densely they are placed") {
  const auto stays = [](double) { return 1.0; };
  CHECK(light_times01(Places(), false) == Times{0.0});
  CHECK(light_times01(Places(stays), false).size() == kEvenTimes);
  CHECK(light_times01(Places(stays, 4.0, 3), false).size() == 513);  // 8 turns, 64 times each
  const Places many(stays, 0.0, 3);
  const SampledLight light(samples_at({0.0}, one));
  for (const std::uint32_t which : {0u, 2u}) {
    const LightInput input = placed_light(LightKind::kSphere, light, many, which, Times{0.0, 1.0}, 0.0);
    CHECK(input.world_from_light.matrices[0][13] == which);
  }
}

TEST_CASE("rotations, mirrors and even scale are similarities; shear and uneven scale are not") {
  const double c = std::cos(1.0), s = std::sin(1.0);
  CHECK(is_similarity({2 * c, 2 * s, 0, 0, -2 * s, 2 * c, 0, 0, 0, 0, -2, 0, 5, 6, 7, 1}));
  CHECK(is_similarity({1, 0, 0, 0, 0, 1 + 1e-6, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
  CHECK_FALSE(is_similarity({1, 0, 0, 0, 0, 1.001, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
  CHECK_FALSE(is_similarity({1, 0, 0, 0, 0.001, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
  CHECK(is_similarity({kNaN, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
  CHECK(is_similarity({}));
}
