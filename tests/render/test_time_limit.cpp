// Frames that end when their time is over.
#include <limits>

#include "core/base/error.h"
#include "core/base/stopwatch.h"
#include "core/film/sum_tree.h"
#include "tests/render/noisy_scenes.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 40;

Image render_within(const RenderSettings& settings, double seconds, RenderStatistics& figures) {
  Renderer renderer;
  renderer.commit(std::make_shared<Scene>(cube_over_floor(kSize, kSize)), settings);
  Image image = renderer.render_within(seconds);
  figures = renderer.statistics();
  return image;
}

bool same(const Image& a, const Image& b) {
  const auto same_values = [](const AovImage& x, const AovImage& y) {
    return x.values == y.values && x.ids == y.ids;
  };
  return a.rgba == b.rgba && a.slices == b.slices && std::ranges::equal(a.aovs, b.aovs, same_values);
}

TEST_CASE(
    "a limit stops early at whole blocks, and says with how many samples the picture is the same to the "
    "bit") {
  for (const std::uint32_t min_spp : {0u, 32u, 128u, 256u}) {  // 0: noise decides nothing
    CAPTURE(min_spp);
    RenderSettings settings{.width = kSize, .height = kSize, .spp = 1 << 20, .max_bounces = 2, .build = {}};
    settings.noise = {min_spp > 0 ? 1e-5f : 0.0f, std::max(1u, min_spp)};
    settings.aovs = {Aov::kSampleCount, Aov::kNoise,        Aov::kNormal,
                     Aov::kPrimId,      Aov::kCryptoObject, Aov::kIndirectDiffuse};
    settings.film.shutter_slices = 2;
    RenderStatistics figures;
    const Stopwatch watch;
    const Image image = render_within(settings, 0.3, figures);
    CHECK(watch.seconds() < 5.0);
    CHECK(figures.spp > 0);
    CHECK(figures.spp < settings.spp);
    CHECK(figures.spp % kBlockSamples == 0);
    settings.spp = figures.spp;
    CHECK(same(image, render(cube_over_floor(kSize, kSize), settings)));
    CHECK(figures.camera_rays <= std::uint64_t(figures.spp) * kSize * kSize);
  }
}

TEST_CASE("where there is time for all samples nothing is changed, at any number of threads") {
  for (const float noise : {0.0f, 0.05f}) {
    for (const std::uint32_t spp : {7u, 32u, 100u}) {
      RenderSettings settings{.width = kSize, .height = kSize, .spp = spp, .max_bounces = 1, .build = {}};
      settings.noise = {noise, 32};
      settings.aovs = {Aov::kSampleCount, Aov::kSeconds};
      settings.threads = 3;
      RenderStatistics figures;
      const Image image = render_within(settings, 1e6, figures);
      CHECK(figures.spp <= spp);
      settings.aovs.clear();
      CHECK(image.rgba == render(cube_over_floor(kSize, kSize), settings).rgba);
    }
  }
}

TEST_CASE("noise is judged where it is without a limit, however many samples come first") {
  for (const std::uint32_t min_spp : {64u, 128u, 256u}) {
    RenderSettings settings{.width = kSize, .height = kSize, .spp = 600, .max_bounces = 1, .build = {}};
    settings.noise = {0.05f, min_spp};
    RenderStatistics figures;
    const Image image = render_within(settings, 1e6, figures);
    CHECK(figures.camera_rays < std::uint64_t(settings.spp) * kSize * kSize);
    CHECK(image.rgba == render(cube_over_floor(kSize, kSize), settings).rgba);
  }
}

TEST_CASE("a limit that is over at once leaves a block of samples") {
  RenderSettings settings{.width = kSize, .height = kSize, .spp = 512, .max_bounces = 1, .build = {}};
  RenderStatistics figures;
  const Image image = render_within(settings, 1e-9, figures);
  CHECK(figures.spp == kBlockSamples);
  settings.spp = kBlockSamples;
  CHECK(image.rgba == render(cube_over_floor(kSize, kSize), settings).rgba);
}

TEST_CASE("a limit that is no time is refused; cancelling works as ever") {
  Renderer renderer;
  renderer.commit(std::make_shared<Scene>(cube_over_floor(8, 8)),
                  {.width = 8, .height = 8, .spp = 1 << 20, .build = {}});
  for (const double seconds : {0.0, -1.0, double(std::numeric_limits<float>::quiet_NaN()),
                               std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_WITH_AS(renderer.render_within(seconds), doctest::Contains("time limit: found"), Error);
  }
  CHECK_THROWS_AS(renderer.render_within(1e6, [](double) { return false; }), Cancelled);
}

}  // namespace
}  // namespace msbvh
