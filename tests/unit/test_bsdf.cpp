// How surfaces reflect: no more than comes in, the same both ways, and sampled as they say.
#include <cmath>
#include <doctest/doctest.h>
#include <vector>

#include "core/integrate/sampler.h"
#include "core/shade/bsdf/albedo_tables.h"
#include "core/shade/bsdf/bsdf.h"
#include "core/shade/bsdf/microfacet.h"
#include "core/shade/warp.h"
#include "tests/unit/chi_square.h"

namespace msbvh {
namespace {

const Vec3f kNormal{0.0f, 0.0f, 1.0f}, kWhite{1.0f, 1.0f, 1.0f};

Vec3f direction(float cosine, float phi) {
  const float sine = std::sqrt(1.0f - cosine * cosine);
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

// `f0`: what is seen head-on, of white.
SurfaceLook mirror(float roughness, float f0) {
  SurfaceLook look;
  look.f0 = kWhite * f0;
  look.f90 = kWhite;
  look.alpha = alpha_of(roughness);
  return look;
}

SurfaceLook plastic(float roughness, float ior, const Vec3f& diffuse) {
  const float ratio = (1.0f - ior) / (1.0f + ior);
  SurfaceLook look = mirror(roughness, ratio * ratio);
  look.diffuse = diffuse;
  return look;
}

SurfaceLook coated(SurfaceLook look, float coat, float roughness) {
  look.coat = coat;
  look.coat_alpha = alpha_of(roughness);
  return look;
}

// What is reflected of light from everywhere, by the lobes' own samples.
Vec3f reflected(const SurfaceLook& look, const Vec3f& out, std::uint32_t samples) {
  const Bsdf bsdf(look, kNormal, out);
  Vec3d sum;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const Sampler sampler(7u, i);
    const BsdfSample sample =
        bsdf.sample(kNormal, sampler.pair(Dimension::kLobe, 0).x, sampler.pair(Dimension::kBounce, 0));
    if (sample.pdf > 0.0f) sum += Vec3d(sample.weight);
  }
  return Vec3f(sum * (1.0 / samples));
}

constexpr float kCosines[] = {0.02f, 0.1f, 0.3f, 0.6f, 0.9f, 1.0f};
constexpr float kRoughnesses[] = {0.0f, 0.1f, 0.3f, 0.5f, 0.7f, 1.0f};

TEST_CASE("a white furnace: what reflects all light gives back all of it") {
  for (const float roughness : kRoughnesses) {
    for (const float cosine : kCosines) {
      CAPTURE(roughness);
      CAPTURE(cosine);
      const Vec3f out = direction(cosine, 0.3f);
      CHECK(reflected(mirror(roughness, 1.0f), out, 16384).x == doctest::Approx(1.0f).epsilon(0.01));
      SurfaceLook diffuse;
      diffuse.diffuse = kWhite;
      CHECK(reflected(diffuse, out, 1024).x == doctest::Approx(1.0f).epsilon(1e-5));
      for (const float ior : {1.1f, 1.5f, 2.4f}) {
        CAPTURE(ior);
        CHECK(reflected(plastic(roughness, ior, kWhite), out, 16384).x ==
              doctest::Approx(1.0f).epsilon(0.01));
      }
    }
  }
}

TEST_CASE("under a coat no light is made, and little is lost over what is white") {
  for (const float roughness : kRoughnesses) {
    for (const float cosine : kCosines) {
      for (const float coat : {0.3f, 1.0f}) {
        CAPTURE(roughness);
        CAPTURE(cosine);
        CAPTURE(coat);
        const Vec3f out = direction(cosine, -1.0f);
        const float white = reflected(coated(plastic(0.5f, 1.5f, kWhite), coat, roughness), out, 16384).x;
        CHECK(white < 1.005f);
        CHECK(white > 1.0f - 0.16f * coat);
        CHECK(reflected(coated(mirror(0.2f, 1.0f), coat, roughness), out, 16384).x < 1.005f);
      }
    }
  }
}

TEST_CASE("albedo() is what is reflected of light from everywhere") {
  for (const float roughness : kRoughnesses) {
    for (const float cosine : kCosines) {
      const SurfaceLook look = plastic(roughness, 1.5f, {0.8f, 0.3f, 0.1f});
      const Vec3f out = direction(cosine, 2.0f), found = reflected(look, out, 16384);
      const Vec3f said = Bsdf(look, kNormal, out).albedo();
      CAPTURE(roughness);
      CAPTURE(cosine);
      CHECK(std::abs(found.x - said.x) < 0.006f);
      CHECK(std::abs(found.z - said.z) < 0.006f);
    }
  }
}

TEST_CASE("light takes both ways alike") {
  std::uint32_t checked = 0;
  for (const float roughness : kRoughnesses) {
    for (const SurfaceLook& look : {mirror(roughness, 0.9f), plastic(roughness, 1.5f, {0.7f, 0.5f, 0.2f}),
                                    coated(plastic(0.4f, 1.8f, {0.2f, 0.5f, 0.9f}), 0.7f, roughness)}) {
      for (std::uint32_t i = 0; i < 64; ++i) {
        const Point2 a = Sampler(1u, i).pair(Dimension::kLens, 0),
                     b = Sampler(2u, i).pair(Dimension::kLens, 1);
        const Vec3f out = direction(0.05f + 0.95f * a.x, 6.0f * a.y),
                    in = direction(0.05f + 0.95f * b.x, 6.0f * b.y);
        const Vec3f there = Bsdf(look, kNormal, out).at(kNormal, in).both() * (1.0f / in.z);
        const Vec3f back = Bsdf(look, kNormal, in).at(kNormal, out).both() * (1.0f / out.z);
        if (std::max(there.x, back.x) > 1e3f) continue;  // a mirror's peak, where a rounding counts
        CHECK(there.x == doctest::Approx(back.x).epsilon(2e-3));
        CHECK(there.z == doctest::Approx(back.z).epsilon(2e-3));
        ++checked;
      }
    }
  }
  CHECK(checked > 1000);
}

// Pearson's chi-square over cells of equal solid angle; the density's share of each by midpoints.
TEST_CASE("directions are sampled with the density that at() gives") {
  constexpr int kZ = 16, kPhi = 24, kFine = 24;
  constexpr std::uint32_t kCount = 200000;
  for (const SurfaceLook& look :
       {mirror(0.35f, 0.9f), mirror(0.7f, 0.5f), plastic(0.5f, 1.5f, {0.5f, 0.5f, 0.5f}),
        coated(plastic(0.6f, 1.5f, {0.5f, 0.2f, 0.1f}), 1.0f, 0.4f)}) {
    for (const float cosine : {0.15f, 0.5f, 0.95f}) {
      const Bsdf bsdf(look, kNormal, direction(cosine, 0.7f));
      std::vector<double> expected(kZ * kPhi), found(kZ * kPhi);
      for (int z = 0; z < kZ * kFine; ++z) {
        for (int phi = 0; phi < kPhi * kFine; ++phi) {
          const float at_z = (float(z) + 0.5f) / (kZ * kFine);
          const float at_phi = (float(phi) + 0.5f) * 2.0f * kPi / (kPhi * kFine);
          expected[std::size_t(z / kFine * kPhi + phi / kFine)] +=
              double(bsdf.at(kNormal, direction(at_z, at_phi)).pdf) * 2.0 * double(kPi) /
              (kZ * kPhi * kFine * kFine);
        }
      }
      double above = 0.0;
      for (std::uint32_t i = 0; i < kCount; ++i) {
        // Not the low-discrepancy points, which are too even for this test.
        const auto random = [i](std::uint32_t k) { return sobol::to_unit_float(hash(hash(9u + k, i))); };
        const BsdfSample sample = bsdf.sample(kNormal, random(0), {random(1), random(2)});
        if (!(sample.pdf > 0.0f)) continue;
        ++above;
        if (i < 2000)
          CHECK(sample.pdf == doctest::Approx(bsdf.at(kNormal, sample.direction).pdf).epsilon(0.02));
        const float phi = std::atan2(sample.direction.y, sample.direction.x);
        const int z = std::min(kZ - 1, int(sample.direction.z * kZ));
        const int p = std::min(kPhi - 1, int((phi < 0.0f ? phi + 2.0f * kPi : phi) * kPhi / (2.0f * kPi)));
        ++found[std::size_t(z * kPhi + p)];
      }
      CAPTURE(cosine);
      CAPTURE(look.alpha);
      check_chi_square(expected, found, kCount, above, 0.02);
    }
  }
}

TEST_CASE("what has no specular lobe is diffuse, to rounding") {
  SurfaceLook look;
  look.diffuse = {0.5f, 0.25f, 0.125f};
  const Bsdf bsdf(look, kNormal, direction(0.4f, 1.0f));
  const Bsdf::Value value = bsdf.at(kNormal, direction(0.7f, 2.0f));
  CHECK(value.both().x == doctest::Approx(0.5f * 0.7f / kPi));
  CHECK(value.pdf == doctest::Approx(0.7f / kPi));
  CHECK(bsdf.albedo().y == doctest::Approx(0.25f));
}

TEST_CASE("nothing that comes out is NaN, however grazing") {
  for (const float cosine : {-0.5f, 0.0f, 1e-20f, 1e-6f}) {
    for (const float roughness : kRoughnesses) {
      const SurfaceLook look = coated(plastic(roughness, 1.5f, kWhite), 1.0f, 0.0f);
      const Bsdf bsdf(look, kNormal, normalize(Vec3f{1.0f, 0.0f, cosine}));
      for (std::uint32_t i = 0; i < 256; ++i) {
        const Sampler sampler(3u, i);
        const BsdfSample sample =
            bsdf.sample(kNormal, sampler.pair(Dimension::kLobe, 0).x, sampler.pair(Dimension::kBounce, 0));
        if (sample.pdf > 0.0f) CHECK(is_finite(sample.weight));
        CHECK(is_finite(bsdf.at(kNormal, sample.direction).both()));
      }
    }
  }
}

}  // namespace
}  // namespace msbvh
