// What shapes a light: cones, focus, IES profiles, multipliers; against UsdLux's formulas.
#include <cmath>
#include <doctest/doctest.h>
#include <memory>

#include "core/shade/light/shaping.h"
#include "tests/unit/light_probe.h"

namespace msbvh {
namespace {
using namespace light_probe;

// A point light above the origin, off its axis by an angle.
Light spot(double off_axis_degrees) {
  const double a = off_axis_degrees * kPiD / 180.0;
  Light light = light_of(LightKind::kSphere, {{float(std::cos(a)), 0, float(-std::sin(a))},
                                              {0, 1, 0},
                                              {float(std::sin(a)), 0, float(std::cos(a))},
                                              {0, 0, 1}});
  light.radius = 0.0f;
  return light;
}

double given(const Light& light) {
  LightSample sample;
  return sample_light(light, {}, {}, 0.0f, {0.5f, 0.5f}, sample) ? double(sample.irradiance.x) : 0.0;
}

TEST_CASE("shaping: a cone's hard and soft edge, and focus, by UsdLux's formulas") {
  Light light = spot(20.0);
  CHECK(given(light) == doctest::Approx(3.0));
  light.cone_angle_degrees = 21.0f;
  CHECK(given(light) == doctest::Approx(3.0));
  light.cone_angle_degrees = 19.0f;
  CHECK(given(light) == 0.0);
  light.cone_angle_degrees = 30.0f;
  light.cone_softness = 0.5f;  // from 15 degrees on: t = 1/3
  CHECK(given(light) == doctest::Approx(3.0 * (1.0 - (3.0 / 9.0 - 2.0 / 27.0))).epsilon(1e-4));
  light.cone_softness = 1.0f;
  CHECK(given(light) == doctest::Approx(3.0 * (1.0 - (3.0 * 4.0 / 9.0 - 2.0 * 8.0 / 27.0))).epsilon(1e-4));
  light = spot(60.0);
  light.focus = 2.0f;
  CHECK(given(light) == doctest::Approx(3.0 * 0.25).epsilon(1e-4));
  light.focus_tint = {1.0f, 0.0f, 0.0f};
  CHECK(given(light) == doctest::Approx(3.0).epsilon(1e-4));
  light = spot(120.0);  // behind: focus takes the absolute value
  light.focus = 1.0f;
  CHECK(given(light) == doctest::Approx(1.5).epsilon(1e-4));
  light.cone_angle_degrees = 90.0f;
  CHECK(given(light) == 0.0);
}

TEST_CASE("shaping: an extended light's samples and finds are shaped alike") {
  for (Light light : extended_lights()) {
    light.cone_angle_degrees = 60.0f;
    light.cone_softness = 0.4f;
    light.focus = 1.5f;
    CAPTURE(int(light.kind));
    const Estimate sampled = irradiance(light);
    const double all = gathered(light);
    CHECK(std::abs(sampled.mean - all) <= 4.5 * sampled.sigma + 2e-3 * all);
  }
}

TEST_CASE("shaping: an IES profile by both angles, its scale and its power") {
  auto profile = std::make_shared<IesProfile>();
  profile->vertical = {0, 90};
  profile->horizontal = {0, 180, 360};
  profile->candela = {10, 0, 20, 0, 10, 0};
  profile->power = 5.0f;
  CHECK(ies_intensity(*profile, 45.0f, 0.0f) == doctest::Approx(5.0));
  CHECK(ies_intensity(*profile, 45.0f, 90.0f) == doctest::Approx(7.5));
  CHECK(ies_intensity(*profile, 45.0f, 270.0f) == doctest::Approx(7.5));
  CHECK(ies_intensity(*profile, 90.5f, 0.0f) == 0.0f);
  Light light = spot(30.0);
  light.ies.profile = profile;
  const double plain = given(light);
  CHECK(plain == doctest::Approx(3.0 * (20.0 * 60.0 / 90.0)).epsilon(1e-3));
  light.ies.normalize = true;
  CHECK(given(light) == doctest::Approx(plain / 5.0).epsilon(1e-5));
  light.ies.normalize = false;
  light.ies.angle_scale = 0.5f;  // 30 degrees read at 60
  CHECK(given(light) == doctest::Approx(3.0 * (20.0 * 30.0 / 90.0)).epsilon(1e-3));
  light.ies.angle_scale = -2.0f;  // (30 - 180) / 2 + 180 = 105: beyond
  CHECK(given(light) == 0.0);
}

TEST_CASE("multipliers come with the sample; a light without controls has them at 1") {
  Light light = light_of(LightKind::kDisk, at({0, 0, 2}));
  light.diffuse = 0.25f;
  light.specular = 3.0f;
  LightSample sample;
  REQUIRE(sample_light(light, {}, {}, 0.0f, {0.5f, 0.5f}, sample));
  CHECK(sample.diffuse == 0.25f);
  CHECK(sample.specular == 3.0f);
  LightAlong along;
  REQUIRE(find_light(light, {}, sample.direction, 0.0f, along));
  CHECK(along.diffuse == 0.25f);
  LightSample plain;
  REQUIRE(sample_light<true, false>(light, {}, {}, 0.0f, {0.5f, 0.5f}, plain));
  CHECK(plain.diffuse == 1.0f);
  CHECK(plain.irradiance == sample.irradiance);
}

}  // namespace
}  // namespace msbvh
