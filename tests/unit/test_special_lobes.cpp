// Glass and fibres: no more light than comes in, what both ways owe each other, and sampled as they say.
#include <cmath>
#include <doctest/doctest.h>
#include <vector>

#include "core/integrate/sampler.h"
#include "core/shade/bsdf/microfacet.h"
#include "core/shade/bsdf/special_lobe.h"
#include "core/shade/material/cover.h"
#include "core/shade/warp.h"
#include "tests/unit/chi_square.h"

namespace msbvh {
namespace {

const Vec3f kNormal{0.0f, 0.0f, 1.0f}, kTangent{1.0f, 0.0f, 0.0f};
constexpr float kCosines[] = {0.05f, 0.3f, 0.6f, 0.9f, 1.0f};
constexpr float kRoughnesses[] = {0.0f, 0.1f, 0.3f, 0.6f, 1.0f};
constexpr float kRatios[] = {1.1f, 1.5f, 2.4f, 1.0f / 1.1f, 1.0f / 1.5f, 1.0f / 2.4f};

Vec3f direction(float cosine, float phi) {
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

// What is scattered of light from everywhere, by the lobe's own samples.
Vec3f scattered(const SpecialLobe& lobe, std::uint32_t samples) {
  Vec3d sum;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const Sampler sampler(7u, i);
    const BsdfSample sample = sample_of(lobe, {}, kNormal, sampler.pair(Dimension::kLobe, 0).x,
                                        sampler.pair(Dimension::kBounce, 0));
    if (sample.pdf > 0.0f) sum += Vec3d(sample.weight);
  }
  return Vec3f(sum * (1.0 / samples));
}

// Pearson's chi-square over cells of equal solid angle; a cell's share of the density by midpoints.
void check_density(const SpecialLobe& lobe) {
  constexpr int kZ = 24, kPhi = 24, kFine = 16;
  constexpr std::uint32_t kCount = 100000;
  std::vector<double> expected(kZ * kPhi), found(kZ * kPhi);
  for (int z = 0; z < kZ * kFine; ++z) {
    for (int phi = 0; phi < kPhi * kFine; ++phi) {
      const Vec3f in = direction(2.0f * (float(z) + 0.5f) / (kZ * kFine) - 1.0f,
                                 (float(phi) + 0.5f) * 2.0f * kPi / (kPhi * kFine));
      expected[std::size_t(z / kFine * kPhi + phi / kFine)] +=
          double(value_of(lobe, {}, kNormal, in).pdf) * 4.0 * double(kPi) / (kZ * kPhi * kFine * kFine);
    }
  }
  double drawn = 0.0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const auto random = [i](std::uint32_t k) { return sobol::to_unit_float(hash(hash(9u + k, i))); };
    const BsdfSample sample = sample_of(lobe, {}, kNormal, random(0), {random(1), random(2)});
    if (!(sample.pdf > 0.0f)) continue;
    ++drawn;
    if (i < 1000) {
      const Bsdf::Value there = value_of(lobe, {}, kNormal, sample.direction);
      CHECK(sample.pdf == doctest::Approx(there.pdf).epsilon(0.02));
      CHECK(sample.weight.y * sample.pdf == doctest::Approx(there.specular.y).epsilon(0.02));
    }
    const float phi = std::atan2(sample.direction.y, sample.direction.x);
    const int z = std::min(kZ - 1, int((sample.direction.z + 1.0f) * 0.5f * kZ));
    const int p = std::min(kPhi - 1, int((phi < 0.0f ? phi + 2.0f * kPi : phi) * kPhi / (2.0f * kPi)));
    ++found[std::size_t(z * kPhi + p)];
  }
  CHECK(check_chi_square(expected, found, kCount, drawn, 0.03) > 15);
}

// Beyond the critical angle tables with so few entries are off by up to 2 % at grazing angles.
TEST_CASE("a white furnace: glass gives back all light, whatever its roughness, on either side") {
  for (const float ratio : kRatios) {
    for (const float roughness : kRoughnesses) {
      for (const float cosine : kCosines) {
        CAPTURE(ratio);
        CAPTURE(roughness);
        CAPTURE(cosine);
        const float white =
            scattered(Glass(ratio, alpha_of(roughness), kNormal, direction(cosine, 0.4f)), 8192).x;
        CHECK(white == doctest::Approx(1.0f).epsilon(cosine < 0.1f && ratio < 1.0f ? 0.02 : 0.01));
      }
    }
  }
}

TEST_CASE("glass gives both ways alike, but for the square of the ior below") {
  std::uint32_t checked = 0, through = 0;
  for (const float ratio : kRatios) {
    for (const float roughness : {0.3f, 0.6f, 1.0f}) {
      for (std::uint32_t i = 0; i < 128; ++i) {
        const Point2 a = Sampler(1u, i).pair(Dimension::kLens, 0),
                     b = Sampler(2u, i).pair(Dimension::kLens, 1);
        const Vec3f out = direction(0.05f + 0.95f * a.x, 6.0f * a.y);
        const Vec3f in = direction((i % 2 ? -1.0f : 1.0f) * (0.05f + 0.95f * b.x), 6.0f * b.y);
        const float alpha = alpha_of(roughness);
        const float there = Glass(ratio, alpha, kNormal, out).at(kNormal, in).specular.x / std::abs(in.z);
        const bool below = in.z < 0.0f;
        // Seen from the other side, whose normal points the other way.
        const Glass other(below ? 1.0f / ratio : ratio, alpha, below ? -kNormal : kNormal, in);
        const float back = other.at(below ? -kNormal : kNormal, out).specular.x / out.z;
        CHECK(there == doctest::Approx(back * (below ? ratio * ratio : 1.0f)).epsilon(2e-3));
        checked += there > 0.0f;
        through += below && there > 0.0f;
      }
    }
  }
  CHECK(checked > 1000);
  CHECK(through > 100);
}

TEST_CASE("glass scatters with the density that at() gives") {
  for (const float ratio : {1.5f, 1.0f / 1.5f, 1.1f}) {
    for (const float cosine : {0.2f, 0.7f}) {
      for (const float roughness : {0.5f, 0.9f}) {
        CAPTURE(ratio);
        CAPTURE(cosine);
        CAPTURE(roughness);
        check_density(Glass(ratio, alpha_of(roughness), kNormal, direction(cosine, 0.7f)));
      }
    }
  }
}

TEST_CASE("smooth glass bends light by Snell's law, and reflects by Fresnel's") {
  const Vec3f out = direction(0.6f, 0.0f);
  for (const float ratio : {1.5f, 1.0f / 1.1f}) {
    const Glass glass(ratio, kLeastAlpha, kNormal, out);
    const Vec3f in = glass.sample(kNormal, 0.999f, {0.5f, 0.5f}).direction;
    CHECK(in.z < 0.0f);
    CHECK(in.x == doctest::Approx(-0.8f / ratio).epsilon(5e-3));
    CHECK(glass.sample(kNormal, 0.005f, {0.5f, 0.5f}).direction.z == doctest::Approx(0.6f).epsilon(5e-3));
  }
  CHECK(fresnel_dielectric(1.0f, 1.5f) == doctest::Approx(0.04f));
  CHECK(fresnel_dielectric(0.0f, 1.5f) == doctest::Approx(1.0f));
  CHECK(fresnel_dielectric(0.7f, 1.0f / 1.5f) == 1.0f);  // beyond the critical angle of 41.8 degrees
  CHECK(fresnel_dielectric(0.3f, 1.0f) < 1e-10f);
  // Head-on and at Brewster's angle light that is polarised along the surface alone is reflected.
  const float brewster = std::cos(std::atan(1.5f));
  CHECK(fresnel_dielectric(brewster, 1.5f) == doctest::Approx(0.5f * 0.1479f).epsilon(1e-3));
}

Fibre fibre(const Vec3f& absorption, float along, float round, float tilt, const Vec3f& out, float offset) {
  FibreLook look;
  look.absorption = absorption;
  look.along = along;
  look.round = round;
  look.tilt_degrees = tilt;
  const Vec3f front = normalize(out - kTangent * dot(out, kTangent)), aside = cross(kTangent, front);
  return {look, kTangent, front * std::sqrt(1.0f - offset * offset) - aside * offset, out};
}

TEST_CASE("a hair that absorbs nothing gives back all light, and one that does no more") {
  for (const float along : {0.1f, 0.3f, 0.6f, 1.0f}) {
    for (const float round : {0.1f, 0.3f, 1.0f}) {
      for (const float cosine : {0.1f, 0.5f, 0.95f}) {
        for (const float offset : {-0.9f, 0.0f, 0.5f}) {
          CAPTURE(along);
          CAPTURE(round);
          CAPTURE(cosine);
          const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.6f * cosine, 0.8f * cosine};
          const Fibre clear = fibre({}, along, round, 2.0f, out, offset);
          CHECK(clear.albedo().x == doctest::Approx(1.0f).epsilon(1e-4));
          CHECK(scattered(clear, 1024).x == doctest::Approx(1.0f).epsilon(2e-3));
          const Fibre dark = fibre({0.5f, 1.0f, 2.0f}, along, round, 2.0f, out, offset);
          CHECK(scattered(dark, 1024).z == doctest::Approx(dark.albedo().z).epsilon(0.03));
          CHECK(dark.albedo().z < dark.albedo().x);
        }
      }
    }
  }
}

// Not by samples: all directions, against the closed form of what the lobes share.
TEST_CASE("what at() gives sums up to the albedo over the sphere") {
  for (const float along : {0.3f, 0.8f}) {
    const Vec3f out = normalize(Vec3f{0.4f, 0.5f, 0.6f});
    const Fibre hair = fibre({0.1f, 0.3f, 1.0f}, along, 0.4f, 2.0f, out, 0.3f);
    Vec3d sum;
    double pdf = 0.0;
    constexpr int kZ = 400, kPhi = 400;
    for (int z = 0; z < kZ; ++z) {
      for (int phi = 0; phi < kPhi; ++phi) {
        const float x = 2.0f * (float(z) + 0.5f) / kZ - 1.0f, turn = 2.0f * kPi * (float(phi) + 0.5f) / kPhi;
        const float s = std::sqrt(1.0f - x * x);
        const Bsdf::Value value = hair.at({x, s * std::cos(turn), s * std::sin(turn)});
        sum += Vec3d(value.specular) * (4.0 * double(kPi) / (kZ * kPhi));
        pdf += double(value.pdf) * 4.0 * double(kPi) / (kZ * kPhi);
      }
    }
    CHECK(pdf == doctest::Approx(1.0).epsilon(2e-3));
    CHECK(sum.x == doctest::Approx(hair.albedo().x).epsilon(2e-3));
    CHECK(sum.z == doctest::Approx(hair.albedo().z).epsilon(2e-3));
  }
}

TEST_CASE("hair scatters with the density that at() gives") {
  for (const float along : {0.4f, 0.9f}) {
    for (const float offset : {-0.7f, 0.1f}) {
      const Vec3f out = normalize(Vec3f{0.3f, -0.5f, 0.7f});
      check_density(fibre({0.2f, 0.4f, 0.8f}, along, 0.6f, 2.0f, out, offset));
    }
  }
}

// The model takes what is absorbed, and the tilt of scales, for who looks: both ways are alike where both
// lean alike against a hair without tilt, over all of its width.
TEST_CASE("hair gives both ways alike where both lean alike") {
  const auto over_width = [](const Vec3f& out, const Vec3f& in) {
    Vec3d sum;
    constexpr int kSteps = 256;
    for (int i = 0; i < kSteps; ++i) {
      const float offset = 2.0f * (float(i) + 0.5f) / kSteps - 1.0f;
      sum += Vec3d(fibre({0.2f, 0.5f, 1.0f}, 0.4f, 0.4f, 0.0f, out, offset).at(in).specular);
    }
    return Vec3f(sum * (1.0 / kSteps));
  };
  for (const float sine : {0.0f, 0.4f, 0.8f}) {
    for (const float turn : {0.5f, 1.5f, 3.0f}) {
      const float c = std::sqrt(1.0f - sine * sine);
      const Vec3f out{sine, 0.0f, c}, in{-sine, c * std::sin(turn), c * std::cos(turn)};
      const Vec3f there = over_width(out, in), back = over_width(in, out);
      CHECK(there.x == doctest::Approx(back.x).epsilon(1e-3));
      CHECK(there.z == doctest::Approx(back.z).epsilon(1e-3));
    }
  }
}

TEST_CASE("absorption is the paper's fit: white absorbs nothing, and darker colours more") {
  CHECK(fibre_absorption({1, 1, 1}, 0.3f) == Vec3f{});
  const Vec3f some = fibre_absorption({0.8f, 0.4f, 0.1f}, 0.3f);
  CHECK(some.x < some.y);
  CHECK(some.y < some.z);
  // (ln 0.5 / 5.9096)^2 by hand, at a roughness of 0.3.
  CHECK(fibre_absorption({0.5f, 0.5f, 0.5f}, 0.3f).x == doctest::Approx(0.013787).epsilon(5e-3));
  CHECK(is_finite(fibre_absorption({0, 0, 0}, 0.3f)));
}

TEST_CASE("hair has no NaN at any angle, offset or roughness") {
  for (const Vec3f& out : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, normalize(Vec3f{1, 0, 1e-5f})}) {
    for (const float roughness : {0.0f, 0.05f, 1.0f}) {
      for (const Vec3f& normal : {Vec3f{0, 0, 1}, Vec3f{0, 1, 0}, Vec3f{1, 0, 0}}) {
        FibreLook look;
        look.along = look.round = roughness;
        look.ior = 1.0f;
        const Fibre hair(look, kTangent, normal, out);
        CHECK(is_finite(hair.albedo()));
        for (std::uint32_t i = 0; i < 64; ++i) {
          const Sampler sampler(3u, i);
          const BsdfSample sample =
              hair.sample(sampler.pair(Dimension::kLobe, 0).x, sampler.pair(Dimension::kBounce, 0));
          CHECK(is_finite(sample.weight));
          CHECK(is_finite(hair.at(direction(sampler.pair(Dimension::kLens, 0).x, 1.0f)).both()));
        }
      }
    }
  }
}

TEST_CASE("what is transparent is met by what it reflects, and by its opacity") {
  SurfaceLook look;
  look.f0 = {0.04f, 0.04f, 0.04f};
  look.f90 = {1, 1, 1};
  look.alpha = alpha_of(0.0f);
  const Vec3f head_on{0, 0, 1}, grazing = direction(0.02f, 0.0f);
  CHECK(transparent_cover(look, 0.0f, kNormal, head_on).chance == doctest::Approx(0.04f).epsilon(0.02));
  CHECK(transparent_cover(look, 0.5f, kNormal, head_on).chance == doctest::Approx(0.52f).epsilon(0.02));
  CHECK(transparent_cover(look, 0.0f, kNormal, grazing).chance > 0.8f);
  const Cover some = transparent_cover(look, 0.25f, kNormal, head_on);
  CHECK(some.diffuse == 0.25f);
  CHECK(some.weight * some.chance == doctest::Approx(1.0f));
  look.f0 = {0.9f, 0.5f, 0.1f};
  CHECK(transparent_cover(look, 0.0f, kNormal, head_on).chance == doctest::Approx(0.9f).epsilon(0.02));
  look.ior = 1.0f;  // bends nothing
  CHECK_FALSE(refracting_cover(look, 0.0f, kNormal, head_on).bends);
  look.ior = 1.5f;
  look.metal = 0.5f;
  CHECK(refracting_cover(look, 0.5f, kNormal, head_on).chance == 0.75f);
  CHECK(refracting_cover(look, 0.5f, kNormal, head_on).bends);
}

}  // namespace
}  // namespace msbvh
