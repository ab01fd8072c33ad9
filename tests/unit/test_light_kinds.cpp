// Each kind of light: how directions are sampled against the density that is said of them, and irradiance
// against closed forms, for a surface at the origin that faces +z.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <vector>

#include "core/base/error.h"
#include "core/shade/light/image.h"
#include "core/shade/light/light_sampler.h"
#include "tests/unit/light_probe.h"

namespace msbvh {
namespace {
using namespace light_probe;

double pdf_along(const Light& light, const Vec3f& direction) {
  LightAlong along;
  return find_light(light, {}, direction, 0.0f, along) ? along.pdf : 0.0;
}

// The mean over a cell of the sphere, times its solid angle.
double mass(const Light& light, double z0, double z1, double a0, double a1) {
  constexpr int kPoints = 24;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j < kPoints; ++j) {
      const double z = z0 + (z1 - z0) * (i + 0.5) / kPoints, a = a0 + (a1 - a0) * (j + 0.5) / kPoints;
      const double pdf = pdf_along(light, on_sphere(z, a));
      if (std::isfinite(pdf)) sum += pdf;
    }
  }
  return sum / (kPoints * kPoints) * (z1 - z0) * (a1 - a0);
}

TEST_CASE("lights: directions are sampled by the density that find_light() says, by chi-square") {
  constexpr int kRows = 12, kColumns = 24;
  for (const Light& light : extended_lights()) {
    CAPTURE(int(light.kind));
    std::vector<double> found(kRows * kColumns, 0.0);
    double missed = 0.0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      LightSample sample;
      if (!sample_light(light, {}, {}, 0.0f, random_pair(i), sample)) {
        ++missed;
        continue;
      }
      const double angle = std::atan2(sample.direction.y, sample.direction.x);
      const int row = std::clamp(int((sample.direction.z + 1.0) / 2.0 * kRows), 0, kRows - 1);
      const int column = std::clamp(int((angle + kPiD) / (2 * kPiD) * kColumns), 0, kColumns - 1);
      ++found[std::size_t(row * kColumns + column)];
    }
    double chi_square = 0.0, total = 0.0, rest_found = 0.0, rest_expected = 0.0;
    int cells = 0;
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const double share =
            mass(light, -1.0 + 2.0 * row / kRows, -1.0 + 2.0 * (row + 1) / kRows,
                 -kPiD + 2 * kPiD * column / kColumns, -kPiD + 2 * kPiD * (column + 1) / kColumns);
        const double expected = share * kSamples, count = found[std::size_t(row * kColumns + column)];
        total += share;
        if (expected < 50.0) {  // too few for the statistic: all such cells are one
          rest_found += count;
          rest_expected += expected;
          continue;
        }
        chi_square += (count - expected) * (count - expected) / expected;
        ++cells;
      }
    }
    CAPTURE(total);
    CHECK(total + missed / kSamples == doctest::Approx(1.0).epsilon(0.01));
    CHECK(std::abs(rest_found - rest_expected) <= 6.0 * std::sqrt(rest_expected + 1.0) + 0.002 * kSamples);
    // Mean `cells`, deviation sqrt(2 cells); the expected counts are integrals of densities with edges.
    CHECK(chi_square <= cells + 6.0 * std::sqrt(2.0 * cells) + 0.15 * cells);
  }
}

TEST_CASE("lights: what is sampled is what a ray in that direction finds") {
  for (const Light& light : extended_lights()) {
    CAPTURE(int(light.kind));
    int found = 0, close = 0;
    for (std::uint32_t i = 0; i < 4000; ++i) {
      LightSample sample;
      if (!sample_light(light, {}, {}, 0.0f, random_pair(i), sample)) continue;
      CHECK(length(sample.direction) == doctest::Approx(1.0).epsilon(1e-5));
      LightAlong along;
      ++found;
      if (!find_light(light, {}, sample.direction, 0.0f, along)) continue;  // past an edge by a rounding
      const bool same_pdf = std::abs(along.pdf - sample.pdf) <= 2e-3f * sample.pdf;
      const Vec3f radiance = sample.irradiance * sample.pdf;
      const bool same_radiance = length(radiance - along.radiance) <= 2e-3f * length(radiance);
      close += same_pdf && same_radiance;
      if (std::isfinite(along.distance))
        CHECK(along.distance == doctest::Approx(sample.distance).epsilon(1e-3));
    }
    CHECK(found > 2000);
    CHECK(close >= found - found / 100);  // the rest crosses from texel to texel
  }
}

TEST_CASE("lights: sampling and finding estimate the same irradiance") {
  for (const Light& light : extended_lights()) {
    CAPTURE(int(light.kind));
    const Estimate sampled = irradiance(light);
    const double all = gathered(light);
    CAPTURE(sampled.mean);
    CAPTURE(all);
    CHECK(std::abs(sampled.mean - all) <= 4.5 * sampled.sigma + 2e-3 * all);
  }
}

// Of a disk that is parallel to the surface, `off` beside its normal: E = L pi F, the form factor of a patch
// and a disk.
double disk_irradiance(double radiance, double radius, double height, double off) {
  const double a = height * height + off * off, r2 = radius * radius;
  return radiance * kPiD * 0.5 * (1.0 - (a - r2) / std::sqrt((a + r2) * (a + r2) - 4.0 * off * off * r2));
}

TEST_CASE("disk: the form factor of a parallel disk, on its axis and beside it; dark behind") {
  Light light = light_of(LightKind::kDisk, at({0, 0, 2}));
  for (const float radius : {0.01f, 0.5f, 5.0f}) {
    light.radius = radius;
    check_irradiance(light, disk_irradiance(3.0, radius, 2.0, 0.0));
  }
  light.world_from_light = {at({1.5f, 0, 2})};
  light.radius = 1.0f;
  check_irradiance(light, disk_irradiance(3.0, 1.0, 2.0, 1.5));
  light.world_from_light[0].x = {-1, 0, 0};  // a mirror in its plane
  check_irradiance(light, disk_irradiance(3.0, 1.0, 2.0, 1.5));
  light.world_from_light[0].z = {0, 0, -1};
  check_irradiance(light, 0.0);
}

// By the surface's points, in double: L cos cos' / d^2.
double cylinder_irradiance(double radius, double length, const Vec3d& middle) {
  constexpr int kAlong = 300, kAround = 800;
  double sum = 0.0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAround; ++j) {
      const double angle = 2 * kPiD * (j + 0.5) / kAround;
      const Vec3d normal{0.0, std::cos(angle), std::sin(angle)};
      const Vec3d p = middle + normal * radius + Vec3d{length * ((i + 0.5) / kAlong - 0.5), 0.0, 0.0};
      const double d2 = dot(p, p), facing = -dot(normal, p);
      if (facing > 0.0 && p.z > 0.0) sum += facing * p.z / (d2 * d2);
    }
  }
  return sum * (2 * kPiD * radius / kAround) * (length / kAlong);
}

TEST_CASE("cylinder: its side by numeric integration; dark within; no ends") {
  Light light = light_of(LightKind::kCylinder, at({0.3f, 0.2f, 2}));
  light.radius = 0.7f;
  light.length = 3.0f;
  check_irradiance(light, 3.0 * cylinder_irradiance(0.7f, 3.0, {0.3f, 0.2f, 2.0}));
  light.world_from_light = {at({5, 0, 2})};
  light.length = 1.0f;
  check_irradiance(light, 3.0 * cylinder_irradiance(0.7f, 1.0, {5, 0, 2}));
  Light stretched = light;  // the same cylinder by a transform
  stretched.radius = 1.0f;
  stretched.length = 0.5f;
  stretched.world_from_light = {{{2, 0, 0}, {0, -0.7f, 0}, {0, 0, 0.7f}, {5, 0, 2}}};
  check_irradiance(stretched, 3.0 * cylinder_irradiance(0.7f, 1.0, {5, 0, 2}));
  light.world_from_light = {at({0, 0, 0.5f})};
  check_irradiance(light, 0.0);
}

TEST_CASE("lights that move and grow are where their tracks say") {
  Light disk = light_of(LightKind::kDisk, at({0, 0, 1}));
  disk.segments = 1;
  disk.world_from_light.push_back(at({0, 0, 3}));
  LightValues small = disk, large = disk;
  small.radius = 0.5f;
  large.radius = 1.5f;
  disk.moving_values = {small, large};
  check_irradiance(disk, disk_irradiance(3.0, 1.0, 2.0, 0.0), 0.5f);
  Light tube = light_of(LightKind::kCylinder, at({0, 0, 2}));
  tube.segments = 1;
  tube.world_from_light.push_back(at({0, 2, 2}));
  LightValues thin = tube;
  thin.length = 1.0f;
  LightValues thick = thin;
  thick.radius = 0.9f;
  thick.length = 3.0f;
  tube.moving_values = {thin, thick};
  check_irradiance(tube, 3.0 * cylinder_irradiance(0.7f, 2.0, {0, 1, 2}), 0.5f);
}

TEST_CASE("a singular cylinder and one without an extent give nothing") {
  Light light = light_of(LightKind::kCylinder, {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 2}});
  check_irradiance(light, 0.0);
  light = light_of(LightKind::kCylinder, at({0, 0, 2}));
  light.radius = 0.0f;
  CHECK_FALSE(has_extent(light));
  check_irradiance(light, 0.0);
  Light disk = light_of(LightKind::kDisk, at({0, 0, 2}));
  disk.radius = 0.0f;
  check_irradiance(disk, 0.0);
}

TEST_CASE("image dome: constant as a constant dome, and by the direction of each format") {
  for (const ImageMap map : {ImageMap::kLatlong, ImageMap::kAngular, ImageMap::kMirroredBall}) {
    Light dome = light_of(LightKind::kDome, {});
    dome.image = picture(map, 64, 32, [](float, float) { return 2.0f; });
    check_irradiance(dome, kPiD * 6.0);
    CHECK(dome.image->mean == doctest::Approx(2.0).epsilon(map == ImageMap::kLatlong ? 1e-5 : 0.02));
    for (std::uint32_t i = 0; i < 500; ++i) {  // places and directions are each other's inverse
      const Point2 r = random_pair(i);
      const Vec3f direction = on_sphere(2.0 * r.x - 1.0, 2 * kPiD * r.y);
      const Point2 place = image_place(map, direction);
      CHECK(length(image_direction(map, place.x, place.y) - direction) < 2e-3f);
    }
    CHECK(image_direction(map, 0.5f, 0.5f).z == doctest::Approx(1.0));  // the middle
    CHECK(image_direction(map, 0.5f, 0.25f).y > 0.5f);                  // up
  }
  CHECK(image_direction(ImageMap::kLatlong, 0.25f, 0.5f).x == doctest::Approx(1.0));   // longitude pi / 2
  CHECK(image_direction(ImageMap::kAngular, 0.75f, 0.5f).x == doctest::Approx(-1.0));  // 90 degrees off
  CHECK(image_direction(ImageMap::kMirroredBall, 0.5f + 0.35355339f, 0.5f).x == doctest::Approx(1.0));
}

TEST_CASE("image dome: turns with its transform, which counts as a rotation") {
  // Bright about +y of the dome, by an image that is bright at its top.
  Light dome = light_of(LightKind::kDome, {});
  dome.image = picture(ImageMap::kLatlong, 16, 64, [](float, float v) { return v < 0.5f ? 1.0f : 0.0f; });
  dome.world_from_light = {
      {{3, 0, 0}, {0, 0, 3}, {0, -3, 0}, {7, 8, 9}}};  // its +y is +z, with a scale and a place
  check_irradiance(dome, gathered(dome));
  CHECK(gathered(dome) == doctest::Approx(3.0 * kPiD).epsilon(0.01));
  dome.world_from_light[0].y = {0, 0, -3};  // a mirror: bright below
  CHECK(gathered(dome) < 0.01 * kPiD);
  Light turning = dome;
  turning.segments = 1;
  turning.world_from_light = {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}}};
  CHECK_FALSE(is_still(turning));
  CHECK(gathered(turning, 0.0f) == doctest::Approx(3.0 * kPiD).epsilon(0.01));
  // Half way the bright half is tilted by 45 degrees: (1 + cos 45) / 2 of it.
  CHECK(gathered(turning, 0.5f) == doctest::Approx(3.0 * kPiD * (1.0 + std::sqrt(0.5)) / 2.0).epsilon(0.02));
}

TEST_CASE("an image that gives nothing is sampled without harm") {
  Light dome = light_of(LightKind::kDome, {});
  dome.image = light_image("black", ImageMap::kLatlong, 3, 2, std::vector<Vec3f>(6));
  check_irradiance(dome, 0.0);
  CHECK(dome.image->mean == 0.0f);
  CHECK_THROWS_WITH_AS(
      light_image("few", ImageMap::kLatlong, 3, 2, {{}}),
      "few: found 1 texels of 3 x 2; expected one at least, and as many as width times height", Error);
  CHECK_THROWS_AS(light_image("nan", ImageMap::kLatlong, 1, 1, {{NAN, 0, 0}}), Error);
  CHECK_THROWS_AS(light_image("none", ImageMap::kLatlong, 0, 0, {}), Error);
}

TEST_CASE("rect image: (0, 0) is the corner at +x and +y, as UsdLuxRectLight has it") {
  Light screen = light_of(LightKind::kRect, at({0, 0, 1}));
  screen.width = screen.height = 2.0f;
  screen.image =
      picture(ImageMap::kRect, 32, 32, [](float u, float v) { return u < 0.5f && v < 0.5f ? 1.0f : 0.0f; });
  LightAlong along;
  REQUIRE(find_light(screen, {}, normalize(Vec3f{0.5f, 0.5f, 1}), 0.0f, along));
  CHECK(along.radiance.x == doctest::Approx(3.0));
  REQUIRE(find_light(screen, {}, normalize(Vec3f{-0.5f, 0.5f, 1}), 0.0f, along));
  CHECK(along.radiance.x == 0.0f);
}

TEST_CASE("image domes are picked as lights, and seen by rays to nowhere") {
  Scene scene;
  Light dome = light_of(LightKind::kDome, {});
  dome.image = picture(ImageMap::kLatlong, 8, 4, [](float, float) { return 1.0f; });
  scene.lights = {dome, dome};
  const LightSampler lights(scene, {{0, 0, 0}, {1, 1, 1}});
  CHECK_FALSE(lights.has_dome());
  CHECK(lights.picks() == 2);
  CHECK(lights.pick(0).extended);
  CHECK(lights.image_domes_radiance({0, 1, 0}, 0.0f).x == doctest::Approx(6.0));
}

}  // namespace
}  // namespace msbvh
