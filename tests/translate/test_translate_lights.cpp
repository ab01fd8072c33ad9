// Lights: their tracks, of transforms and of values, and their checks.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

#include "core/motion/track.h"
#include "core/scene/scene.h"
#include "delegate/translate/moving_light.h"
#include "delegate/translate/translator.h"
#include "delegate/translate/value_track.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

LightInput light_of(LightKind kind, const TransformSamples& transform) {
  LightInput input;
  input.light.name = "/light";
  input.light.kind = kind;
  input.world_from_light = transform;
  return input;
}

// `value` changes the light of its kind at each time.
using Change = std::function<void(double time01, LightValues& values)>;
LightInput changing(LightKind kind, const std::vector<double>& times01, const Change& change,
                    const TransformSamples& transform = still(translation({0, 0, -5}))) {
  LightInput input = light_of(kind, transform);
  input.values_times01 = times01;
  for (const double time01 : times01) {
    input.values.push_back(input.light);
    change(time01, input.values.back());
  }
  return input;
}

Change intensity(const std::function<double(double)>& curve) {
  return [curve](double time01, LightValues& values) {
    values.radiance = Vec3f{1, 0.5f, 0.25f} * float(curve(time01));
  };
}

Light translated(const LightInput& input) {
  Translator translator(camera_at({}), settings_of());
  translator.add_light(input);
  for (const Diagnostic& d : translator.diagnostics()) FAIL(d.attribute << ": " << d.message);
  const auto scene = translator.finish();
  validate(*scene);
  REQUIRE(scene->lights.size() == 1);
  return scene->lights[0];
}

// The number that `value` gives at a time.
template <typename Value>
double at(const Light& light, double time01, const Value& value) {
  if (light.moving_values.empty()) return value(static_cast<const LightValues&>(light));
  const SegmentTime place = locate(float(time01), light.segments);
  return (1 - place.w) * value(light.moving_values[place.key]) +
         place.w * value(light.moving_values[place.key + 1]);
}
double red(const LightValues& values) { return values.radiance.x; }
double radius(const LightValues& values) { return values.radius; }

double integral_of_red(const Light& light) {
  double sum = 0;
  for (std::uint32_t i = 0; i < light.segments; ++i) {
    sum += 0.5 * (red(light.moving_values[i]) + red(light.moving_values[i + 1])) / light.segments;
  }
  return sum;
}

// 1 from `on` to `off`, with a sample on either side of each jump.
LightInput blinking(double on, double off) {
  std::vector<double> times01 = uniform_times(16);
  for (const double jump : {on, off}) {
    if (jump > 0.0 && jump < 1.0) times01.insert(times01.end(), {jump - 1e-6, jump});
  }
  std::sort(times01.begin(), times01.end());
  return changing(LightKind::kDome, times01, intensity([=](double u) { return u >= on && u < off; }));
}

}  // namespace

TEST_SUITE("translate: lights") {
  TEST_CASE("lights move with the fewest keys; the direction of a distant one does not depend on its place") {
    Translator translator(camera_at({}), settings_of());
    const auto slide = [](double u) { return translation({1e9 * u, 0, -5}); };
    translator.add_light(light_of(LightKind::kDistant, sampled(slide, {0.0, 1.0})));
    translator.add_light(light_of(LightKind::kSphere, sampled(
                                                          [](double u) {
                                                            return translation({u, 0, -5});
                                                          },
                                                          {0.0, 1.0})));
    translator.add_light(
        light_of(LightKind::kDome, sampled([](double u) { return rotation(90 * u); }, uniform_times(64))));
    CHECK(translator.diagnostics().empty());
    const auto scene = translator.finish();
    validate(*scene);
    REQUIRE(scene->lights.size() == 3);
    CHECK(scene->lights[0].segments == 0);
    CHECK(scene->lights[1].segments == 1);
    CHECK(scene->lights[1].world_from_light[1].t == Vec3f{1, 0, -5});
    CHECK(scene->lights[2].segments >= 16);
  }

  TEST_CASE("lights that cannot be used are left out with an error") {
    Translator translator(camera_at({}), settings_of());
    LightInput dark = light_of(LightKind::kSphere, still());
    dark.light.radius = -1;
    translator.add_light(dark);
    LightInput blazing = light_of(LightKind::kDome, still());
    blazing.light.radiance.x = std::numeric_limits<float>::infinity();
    translator.add_light(blazing);
    translator.add_light(light_of(LightKind::kRect, {}));
    CHECK(count(translator, Severity::kError, "inputs:radius") == 1);
    CHECK(count(translator, Severity::kError, "inputs:intensity") == 1);
    CHECK(count(translator, Severity::kError, "xformOpOrder") == 1);
    CHECK(translator.finish()->lights.empty());
  }

  TEST_CASE("a material that is not finite becomes the default one and keeps its index") {
    Translator translator(camera_at({}), settings_of());
    Material broken;
    broken.name = "/broken";
    broken.opacity = std::numeric_limits<float>::quiet_NaN();
    CHECK(translator.add_material(broken) == 0);
    CHECK(translator.add_material({}) == 1);
    CHECK(count(translator, Severity::kWarning, "inputs") == 1);
    validate(*translator.finish());
  }

  TEST_CASE("values that do not change over many samples are still") {
    const auto same = [](double, LightValues& values) { values.radiance = {2, 3, 4}; };
    const Light light = translated(changing(LightKind::kRect, uniform_times(64), same));
    CHECK(light.segments == 0);
    CHECK(light.moving_values.empty());
    CHECK(light.radiance == Vec3f{2, 3, 4});
  }

  TEST_CASE("what rounding leaves over when normalisation cancels motion is still") {
    const Change noise = intensity([](double u) { return 1.0 + 1e-7 * std::sin(1e3 * u); });
    CHECK(translated(changing(LightKind::kSphere, uniform_times(128), noise)).segments == 0);
  }

  TEST_CASE("a linear ramp takes one segment and is exact") {
    const Light light =
        translated(changing(LightKind::kSphere, {-1.0, 3.0}, intensity([](double u) { return 8 + 4 * u; })));
    CHECK(light.segments == 1);
    CHECK(light.moving_values.at(0).radiance == Vec3f{8, 4, 2});
    CHECK(light.moving_values.at(1).radiance == Vec3f{12, 6, 3});
    CHECK(light.world_from_light.size() == 2);
  }

  TEST_CASE("curves of intensity are followed within 1 % of the largest, by few keys") {
    std::function<double(double)> curve;
    std::uint32_t most =
        0;  // the next power of two at which h^2 / 8 times the largest curvature is below 1 %
    SUBCASE("a ramp of exposure") {
      curve = [](double u) { return std::exp2(4 * u); };
      most = 16;
    }
    SUBCASE("a flash") {
      curve = [](double u) { return std::exp(-200 * (u - 0.4) * (u - 0.4)); };
      most = 128;
    }
    const Light light = translated(changing(LightKind::kDome, uniform_times(128), intensity(curve)));
    double worst = 0, largest = 0;
    for (const double u : uniform_times(1000)) {
      worst = std::max(worst, std::abs(at(light, u, red) - curve(u)));
      largest = std::max(largest, curve(u));
    }
    CHECK(light.segments > 1);
    CHECK(light.segments <= most);
    CHECK(worst <= (kPowerTolerance + 0.002) * largest);  // chords of the samples themselves
  }

  TEST_CASE("a radius follows in pixels, and its light's power within 1 %") {
    // Normalised: radiance falls as the square of the radius grows, their product stays.
    const Light light =
        translated(changing(LightKind::kSphere, uniform_times(128), [](double u, LightValues& v) {
          v.radius = float(0.2 + 0.8 * u);
          v.radiance = Vec3f{1, 1, 1} * (1 / (v.radius * v.radius));
        }));
    CHECK(light.segments >= 4);
    for (const double u : uniform_times(1000)) {
      const double r = at(light, u, radius), l = at(light, u, red);
      CHECK(std::abs(l * r * r - 1.0) <= kPowerTolerance + 1e-3);
      CHECK(std::abs(r - (0.2 + 0.8 * u)) <= 1e-4);
    }
  }

  TEST_CASE("an angle follows as directions do") {
    const Light light =
        translated(changing(LightKind::kDistant, uniform_times(128),
                            [](double u, LightValues& v) { v.angle_degrees = float(10 + 20 * u * u); }));
    CHECK(light.segments >= 4);
    for (const double u : uniform_times(200)) {
      const double angle = at(light, u, [](const LightValues& v) { return double(v.angle_degrees); });
      CHECK(std::abs(angle - (10 + 20 * u * u)) <= 0.02);
    }
  }

  TEST_CASE("transform and values share their keys") {
    const auto turn = sampled(
        [](double u) {
          return translation({0, 0, -5}) * rotation(90 * u);
        },
        uniform_times(64));
    const Light light =
        translated(changing(LightKind::kRect, {0.0, 1.0}, intensity([](double u) { return 1 + u; }), turn));
    CHECK(light.segments >= 8);
    CHECK(light.moving_values.size() == light.world_from_light.size());
    CHECK(at(light, 0.375, red) == doctest::Approx(1.375).epsilon(1e-5));
  }

  TEST_CASE("a light that is switched keeps its mean to the last digits") {
    for (const auto& [on, off] : {std::pair{0.3, 2.0}, {0.0, 0.61}, {0.47, 0.485}, {0.123, 0.877}}) {
      CAPTURE(on);
      const Light light = translated(blinking(on, off));
      CHECK(std::abs(integral_of_red(light) / (std::min(off, 1.0) - on) - 1.0) <= 1e-4);
      CHECK(at(light, on / 2, red) == doctest::Approx(on == 0.0 ? 1.0 : 0.0).epsilon(1e-6));
    }
  }

  TEST_CASE("a light that is switched while its size changes: both are followed, without a warning") {
    LightInput input = blinking(0.51, 2.0);
    input.light.kind = LightKind::kSphere;
    for (std::size_t i = 0; i < input.values.size(); ++i) {
      input.values[i].radius = float(0.2 + 0.8 * input.values_times01[i]);
    }
    const Light light = translated(input);
    for (const double u : uniform_times(50)) CHECK(std::abs(at(light, u, radius) - (0.2 + 0.8 * u)) <= 0.003);
  }

  TEST_CASE("a light that flickers faster than keys can follow is named, and keeps its mean") {
    std::vector<double> times01{0.0};
    for (int i = 1; i < 10; ++i) times01.insert(times01.end(), {i / 10.0 - 1e-6, i / 10.0});
    TranslatorSettings settings = settings_of();
    settings.max_segments = 4;
    Translator translator(camera_at({}), settings);
    translator.add_light(
        changing(LightKind::kDome, times01, intensity([](double u) { return int(u * 10 + 1e-9) % 2; })));
    REQUIRE(count(translator, Severity::kWarning, "inputs:intensity") == 1);
    CHECK(translator.diagnostics()[0].message.find("jumps inside the shutter; its mean is kept") !=
          std::string::npos);
    const auto scene = translator.finish();
    CHECK(integral_of_red(scene->lights[0]) == doctest::Approx(0.5).epsilon(1e-3));
  }

  TEST_CASE("values that cannot be used leave the light out") {
    Translator translator(camera_at({}), settings_of());
    const auto ramp = intensity([](double u) { return 1 + u; });
    LightInput light = changing(LightKind::kSphere, {0.0, 1.0}, ramp);
    light.values[1].radiance.y = std::numeric_limits<float>::quiet_NaN();
    translator.add_light(light);
    light = changing(LightKind::kSphere, {0.0, 1.0}, ramp);
    light.values.pop_back();
    translator.add_light(light);
    CHECK(count(translator, Severity::kError, "inputs:intensity") == 2);
    light = changing(LightKind::kSphere, {0.0, 1.0}, ramp);
    light.values[0].radius = 0.0f;
    translator.add_light(light);
    light.values[0].radius = -1.0f;
    translator.add_light(light);
    CHECK(count(translator, Severity::kError, "inputs:radius") == 2);
    CHECK(translator.finish()->lights.empty());
  }
}

TEST_SUITE("translate: value tracks") {
  double value(const Mix& mix, const std::vector<double>& values) {
    double sum = 0;
    for (const Share& share : mix) sum += share.weight * values[share.sample];
    return sum;
  }

  TEST_CASE("averaged keys keep the integral of any samples, at any key count") {
    const std::vector<double> times01{-0.5, 0.1, 0.35, 0.350001, 0.8, 1.7}, values{3, 1, 4, -1, 5, 9};
    double exact = 0;
    for (int i = 0; i < 1000000; ++i) exact += value(mix_at(times01, (i + 0.5) * 1e-6), values) * 1e-6;
    for (const std::uint32_t segments : {0u, 1u, 4u, 32u}) {
      const std::vector<Mix> keys = key_mixes(times01, segments, Keys::kAveraged);
      double sum = segments == 0 ? value(keys[0], values) : 0.0;
      for (std::uint32_t i = 0; i < segments; ++i) {
        sum += 0.5 * (value(keys[i], values) + value(keys[i + 1], values)) / segments;
      }
      CHECK(sum == doctest::Approx(exact).epsilon(1e-6));
    }
  }

  TEST_CASE("sampled keys are the samples' value at the key") {
    const std::vector<double> times01{0.0, 0.5, 1.0}, values{1, 3, 2};
    const std::vector<Mix> keys = key_mixes(times01, 4, Keys::kSampled);
    CHECK(value(keys[1], values) == 2.0);
    CHECK(value(keys[2], values) == 3.0);
    CHECK(value(keys[3], values) == 2.5);
  }

  TEST_CASE("a deviation is the largest difference, or what has come too early or too late") {
    Deviation sampled(Keys::kSampled), averaged(Keys::kAveraged);
    // Half a unit too much for 0.2 of the shutter, then as much too little.
    for (const auto& [time01, x] :
         {std::pair{0.0, 0.5}, {0.2, 0.5}, {0.200001, -0.5}, {0.4, -0.5}, {1.0, 0.0}}) {
      sampled.add(time01, {x, 0, 0});
      averaged.add(time01, {0, x, 0});
    }
    CHECK(sampled.largest() == 0.5);
    CHECK(averaged.largest() == doctest::Approx(0.15).epsilon(1e-4));  // 0.1 - 0.1 - 0.5 * 0.6 / 2
  }
}
