// The mean over many samples of irradiance * cosine against the closed form, for a surface at the origin that
// faces +z.
#include <cmath>
#include <doctest/doctest.h>
#include <map>

#include "core/integrate/sampler.h"
#include "core/shade/light/light.h"
#include "core/shade/light/light_sampler.h"
#include "core/shade/light/light_tree.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr int kSamples = 1 << 16;

struct Estimate {
  double mean, sigma;  // of the mean
};

// Independent scrambles of one point each, so that the samples are independent of one another.
Estimate irradiance(const Light& light, const Camera& camera = {}, float time = 0.0f) {
  double sum = 0, sum_of_squares = 0;
  for (int i = 0; i < kSamples; ++i) {
    LightSample sample;
    const Point2 random = Sampler(PixelSampler(0, i, 0), 0).pair(Dimension::kLight, 0);
    double value = 0;
    if (sample_light(light, camera, {}, time, random, sample)) {
      CHECK(length(sample.direction) == doctest::Approx(1.0).epsilon(1e-5));
      value = sample.irradiance.x * std::max(0.0f, sample.direction.z);
    }
    sum += value;
    sum_of_squares += value * value;
  }
  const double mean = sum / kSamples;
  return {mean, std::sqrt(std::max(0.0, sum_of_squares / kSamples - mean * mean) / kSamples)};
}

// 4.5 standard deviations, and single precision's share.
void check_estimate(const Estimate& found, double expected) {
  CAPTURE(found.mean);
  CAPTURE(expected);
  CHECK(std::abs(found.mean - expected) <= 4.5 * found.sigma + 1e-5 * std::abs(expected));
}

// Looks down at the origin from `position`: the light's -z axis is the world's -z axis.
Light light_at(LightKind kind, const Vec3f& position) {
  Light light;
  light.kind = kind;
  light.radiance = {3.0f, 1.0f, 1.0f};
  light.world_from_light = {Affine3f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, position}};
  return light;
}

TEST_CASE("distant: E = pi L sin^2(a), a the half angle") {
  for (const float degrees : {0.53f, 20.0f, 120.0f, 180.0f}) {
    Light light = light_at(LightKind::kDistant, {});
    light.angle_degrees = degrees;
    const double sine = std::sin(degrees * kPi / 360.0);
    check_estimate(irradiance(light), 3.0 * kPi * sine * sine);
  }
}

TEST_CASE("distant without an extent: its radiance is the irradiance, along its own axis") {
  Light light = light_at(LightKind::kDistant, {5, 6, 7});
  light.angle_degrees = 0.0f;
  check_estimate(irradiance(light), 3.0);
  light.world_from_light = {Affine3f{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {}}};  // shines along +y
  LightSample sample;
  REQUIRE(sample_light(light, {}, {}, 0.0f, {0.5f, 0.5f}, sample));
  CHECK(sample.direction == Vec3f{0, -1, 0});
  CHECK(std::isinf(sample.distance));
}

TEST_CASE("sphere: E = pi L r^2 / d^2 cos(theta) while it stands above the horizon") {
  Light light = light_at(LightKind::kSphere, {0, 3, 4});
  for (const float radius : {1e-3f, 0.5f, 3.9f}) {
    light.radius = radius;
    check_estimate(irradiance(light), 3.0 * kPi * radius * radius / 25.0 * (4.0 / 5.0));
  }
  light.world_from_light[0].x = {2, 0, 0};
  light.world_from_light[0].y = {0, 2, 0};
  light.world_from_light[0].z = {0, 0, 2};
  light.radius = 0.5f;
  check_estimate(irradiance(light), 3.0 * kPi / 25.0 * (4.0 / 5.0));
}

TEST_CASE("sphere: the sampled point lies on the sphere, on the near side") {
  Light light = light_at(LightKind::kSphere, {1, 3, 4});
  light.radius = 2.0f;
  for (int i = 0; i < 1000; ++i) {
    LightSample sample;
    REQUIRE(sample_light(light, {}, {}, 0.0f, Sampler(PixelSampler(0, i, 0), 0).pair(Dimension::kLight, 0),
                         sample));
    const Vec3f on_sphere = sample.direction * sample.distance - Vec3f{1, 3, 4};
    CHECK(length(on_sphere) == doctest::Approx(2.0).epsilon(1e-4));
    CHECK(dot(on_sphere, sample.direction) <= 1e-3f);
  }
}

TEST_CASE("sphere: dark inside; a point light falls with the square of the distance") {
  Light light = light_at(LightKind::kSphere, {0, 0, 1});
  light.radius = 2.0f;
  check_estimate(irradiance(light), 0.0);
  light = light_at(LightKind::kSphere, {0, 0, 4});
  light.radius = 0.0f;
  check_estimate(irradiance(light), 3.0 / 16.0);
}

// Lambert's formula for a polygon: E = L / 2 * sum over its edges of angle times the edge plane's normal,
// along +z.
double lambert(const std::array<Vec3d, 4>& corner, double radiance) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const Vec3d a = normalize(corner[i]), b = normalize(corner[(i + 1) % 4]);
    sum += std::acos(dot(a, b)) * normalize(cross(a, b)).z;
  }
  return std::abs(sum) * radiance / 2;
}

TEST_CASE("rect: Lambert's polygon formula; one-sided, also in a mirror") {
  Light light = light_at(LightKind::kRect, {0.5f, 0, 2});
  light.width = 3.0f;
  light.height = 1.0f;
  const double expected = lambert({{{-1, -0.5, 2}, {2, -0.5, 2}, {2, 0.5, 2}, {-1, 0.5, 2}}}, 3.0);
  check_estimate(irradiance(light), expected);
  light.world_from_light[0].x = {-1, 0, 0};  // a mirror in its plane: the same light
  check_estimate(irradiance(light), expected);
  light.world_from_light[0].z = {0, 0, -1};  // turned away
  check_estimate(irradiance(light), 0.0);
}

TEST_CASE(
    "camera: pi at normal incidence at any distance, from where the camera is at the time, without shadow") {
  Camera camera;
  camera.segments = 1;
  camera.world_from_camera = {Affine3f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 100}},
                              Affine3f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {200, 0, 100}}};
  Light light;
  light.kind = LightKind::kCamera;
  check_estimate(irradiance(light, camera, 0.0f), kPi);
  check_estimate(irradiance(light, camera, 0.5f), kPi * std::sqrt(0.5));
  LightSample sample;
  REQUIRE(sample_light(light, camera, {}, 0.0f, {0.5f, 0.5f}, sample));
  CHECK_FALSE(sample.casts_shadow);
}

TEST_CASE("a moving light is where its track says") {
  Light light = light_at(LightKind::kSphere, {0, 0, 1});
  light.radius = 0.0f;
  light.segments = 1;
  light.world_from_light.push_back(Affine3f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 3}});
  check_estimate(irradiance(light, {}, 0.5f), 3.0 / 4.0);
}

// `light` at its two keys, otherwise as it is.
Light with_keys(Light light, const LightValues& first, const LightValues& second) {
  light.segments = 1;
  light.world_from_light.resize(2, light.world_from_light[0]);
  light.moving_values = {first, second};
  return light;
}

TEST_CASE("radiance and sizes are linear between their keys") {
  Light light = light_at(LightKind::kSphere, {0, 0, 4});
  LightValues small = light, large = light;
  small.radius = 0.5f;
  large.radius = 1.5f;
  large.radiance = small.radiance * 3.0f;
  light = with_keys(light, small, large);
  check_estimate(irradiance(light, {}, 0.0f), 3.0 * kPi * 0.25 / 16);
  check_estimate(irradiance(light, {}, 0.5f), 6.0 * kPi * 1.0 / 16);
  check_estimate(irradiance(light, {}, 1.0f), 9.0 * kPi * 2.25 / 16);

  Light sun = light_at(LightKind::kDistant, {});
  LightValues narrow = sun, wide = sun;
  narrow.angle_degrees = 10.0f;
  wide.angle_degrees = 110.0f;
  sun = with_keys(sun, narrow, wide);
  check_estimate(irradiance(sun, {}, 0.5f), 3.0 * kPi * 0.25);  // 60 degrees: sin^2(30) is a quarter
}

TEST_CASE("a light that is off at a time is not sampled then") {
  Light light = light_at(LightKind::kRect, {0, 0, 2});
  LightValues off = light;
  off.radiance = {};
  light = with_keys(light, off, light);
  LightSample sample;
  CHECK_FALSE(sample_light(light, {}, {}, 0.0f, {0.5f, 0.5f}, sample));
  CHECK(sample_light(light, {}, {}, 0.1f, {0.5f, 0.5f}, sample));
}

constexpr Box3f kUnit{{0, 0, 0}, {1, 1, 1}};

TEST_CASE("domes that fade are summed with still ones at the time") {
  Scene scene;
  Light still = light_at(LightKind::kDome, {});
  LightValues off = still;
  off.radiance = {};
  scene.lights = {still, with_keys(still, off, still)};
  const LightSampler lights(scene, kUnit);
  CHECK(lights.dome_radiance(0.0f) == Vec3f{3, 1, 1});
  CHECK(lights.dome_radiance(0.5f) == Vec3f{4.5f, 1.5f, 1.5f});
  CHECK(lights.dome_radiance(1.0f) == Vec3f{6, 2, 2});
}

TEST_CASE("domes are summed, the rest is picked, each where there are few, none that does not shine") {
  Scene scene;
  scene.lights = {light_at(LightKind::kDome, {}), light_at(LightKind::kRect, {}),
                  light_at(LightKind::kDome, {}), light_at(LightKind::kDistant, {})};
  scene.lights[3].radiance = {};
  const LightSampler lights(scene, kUnit);
  CHECK(lights.has_dome());
  CHECK(lights.dome_radiance(0.5f) == Vec3f{6, 2, 2});
  REQUIRE(lights.picks() == 1);
  CHECK(lights.pick(0).light == &scene.lights[1]);
  CHECK(lights.pick(0).expected == 1.0f);
}

TEST_CASE(
    "of many lights each is picked as often as it says, and at least a quarter as often as if all were "
    "alike") {
  Scene scene;
  for (int i = 0; i < 50; ++i) {
    const LightKind kind = i % 7 == 0   ? LightKind::kDistant
                           : i % 3 == 0 ? LightKind::kSphere
                           : i % 3 == 1 ? LightKind::kRect
                                        : LightKind::kCylinder;
    scene.lights.push_back(light_at(kind, {float(i % 8), float(i % 5), float(i % 11) - 2.0f}));
    scene.lights.back().radiance = Vec3f{1, 1, 1} * std::pow(1.5f, float(i % 23));
    if (i % 6 == 0) scene.lights.back().cone_angle_degrees = 40.0f;
    if (i % 10 == 0) {
      scene.lights.back().segments = 1;
      scene.lights.back().world_from_light.push_back(scene.lights.back().world_from_light[0]);
    }
  }
  const LightSampler lights(scene, kUnit);
  REQUIRE(lights.picks() == kLightPicks);
  for (const Vec3f& point : {Vec3f{0, 0, 0}, Vec3f{3, 2, 4}, Vec3f{-50, 1, 3}}) {
    for (const Vec3f& normal : {Vec3f{0, 0, 1}, Vec3f{0.6f, 0, -0.8f}}) {
      std::map<const Light*, double> found, expected;
      constexpr int kDraws = 1 << 16;
      for (int i = 0; i < kDraws; ++i) {
        for (std::uint32_t which = 0; which < kLightPicks; ++which) {
          const LightPick pick = lights.pick(which, (float(i) + 0.5f) / kDraws, point, normal);
          found[pick.light] += 1.0 / kDraws;
          expected[pick.light] = pick.expected;
        }
      }
      REQUIRE(found.size() == scene.lights.size());
      double sum = 0.0;
      for (const auto& [light, share] : found) {
        CHECK(std::abs(share - expected[light]) <= 1e-3 * expected[light] + 4e-4);
        CHECK(share >= 0.249 * kLightPicks / 50);
        sum += expected[light];
      }
      CHECK(sum == doctest::Approx(kLightPicks).epsilon(1e-4));
    }
  }
}

TEST_CASE("importance is 0 only where a light gives nothing, and bounds hold all that they unite") {
  std::vector<LightReach> reaches;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const Point2 a = Sampler(PixelSampler(5, i, 0), 0).pair(Dimension::kLight, 0);
    const Point2 b = Sampler(PixelSampler(6, i, 0), 0).pair(Dimension::kLight, 0);
    LightReach reach;
    const Vec3f place{a.x * 10, a.y * 10, b.x * 10};
    reach.box = {place, place + Vec3f{b.y, a.x, a.y}};
    reach.axis = sample_cone(b, 2.0f);
    reach.cos_around = 1.0f - a.x;
    reach.cos_beyond = 0.0f;
    reach.power = 1.0f;
    reaches.push_back(reach);
  }
  const LightTree tree(reaches);
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const Point2 a = Sampler(PixelSampler(7, i, 0), 0).pair(Dimension::kLight, 0);
    const Point2 b = Sampler(PixelSampler(8, i, 0), 0).pair(Dimension::kLight, 0);
    const Vec3f point{a.x * 14 - 2, a.y * 14 - 2, b.x * 14 - 2}, normal = sample_cone({b.y, a.x}, 2.0f);
    double sum = 0.0;
    for (std::uint32_t light = 0; light < reaches.size(); ++light) {
      const float chance = tree.chance(light, point, normal);
      sum += chance;
      // What reaches the point, by more than roundings, is reached through the tree.
      LightReach narrower = reaches[light];
      narrower.box = {narrower.box.lo + Vec3f{1, 1, 1} * 1e-3f, narrower.box.hi - Vec3f{1, 1, 1} * 1e-3f};
      narrower.cos_beyond = 0.01f;
      if (!narrower.box.empty() && importance(narrower, point, normal) > 0.0f) CHECK(chance > 0.0f);
    }
    CHECK(sum == doctest::Approx(1.0).epsilon(1e-4));
    // Without a normal light counts from either side.
    CHECK(importance(reaches[i % 40], point, {}) >= importance(reaches[i % 40], point, normal));
    CHECK(tree.chance(tree.pick(a.x, point, normal).light, point, normal) ==
          doctest::Approx(tree.pick(a.x, point, normal).chance));
  }
}

TEST_CASE("lights in one place, and lights of no power, can all be picked") {
  std::vector<LightReach> reaches(100);
  for (LightReach& reach : reaches) reach.box.grow(Vec3f{1, 2, 3});
  const LightTree tree(reaches);
  for (std::uint32_t light = 0; light < 100; ++light)
    CHECK(tree.chance(light, {0, 0, 0}, {0, 0, 1}) == doctest::Approx(0.01).epsilon(0.8));
}

// By chance a ray meets a light as often as the density says: the estimate by directions that are uniform on
// the sphere is that by samples of the light.
TEST_CASE("a light that a ray finds has the radiance and density of its samples") {
  Light rect = light_at(LightKind::kRect, {0.5f, 0, 2});
  rect.width = 3.0f;
  rect.world_from_light[0].x = {-1, 0.2f, 0};
  Light sphere = light_at(LightKind::kSphere, {0, 3, 4});
  sphere.radius = 2.0f;
  Light sun = light_at(LightKind::kDistant, {});
  sun.angle_degrees = 40.0f;
  for (const Light& light : {rect, sphere, sun}) {
    double solid_angle = 0, by_density = 0;
    for (int i = 0; i < kSamples; ++i) {
      const Point2 random = Sampler(PixelSampler(1, 0, 0), i).pair(Dimension::kLight, 0);
      LightAlong along;
      if (find_light(light, {}, sample_cone(random, 2.0f), 0.0f, along)) {
        CHECK(along.radiance == light.radiance);
        solid_angle += 4 * kPi / kSamples;
        by_density += along.pdf * 4 * kPi / kSamples;
      }
      LightSample sample;
      REQUIRE(sample_light(light, {}, {}, 0.0f, random, sample));
      REQUIRE(sample.pdf > 0.0f);
      CHECK(sample.irradiance.x == doctest::Approx(light.radiance.x / sample.pdf).epsilon(1e-4));
      // Inwards a little, since rounding decides at the rim.
      const Vec3f axis = light.kind == LightKind::kDistant ? Vec3f{0, 0, 1} : light.world_from_light[0].t;
      const Vec3f inwards = normalize(sample.direction + normalize(axis) * 1e-3f);
      REQUIRE(find_light(light, {}, inwards, 0.0f, along));
      CHECK(along.pdf == doctest::Approx(sample.pdf).epsilon(0.02));
      if (light.kind != LightKind::kDistant)
        CHECK(along.distance == doctest::Approx(sample.distance).epsilon(0.05));
    }
    CHECK(solid_angle > 0.1);
    CHECK(by_density == doctest::Approx(1.0).epsilon(0.02));
  }
}

}  // namespace
}  // namespace msbvh
