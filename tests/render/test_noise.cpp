// Noise that ends: how many samples pixels take, and what pictures of them are.
#include <limits>
#include <map>
#include <sstream>

#include "core/base/error.h"
#include "core/film/sum_tree.h"
#include "tests/render/noisy_scenes.h"
#include "tests/support/soak.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 16;                 // of stripes
constexpr std::uint32_t kWidth = 26, kHeight = 18;  // squares and tiles that are cut off

std::vector<Aov> all_that_repeat() {
  std::vector<Aov> aovs;
  for (std::size_t i = 0; i < kAovCount; ++i) {
    if (Aov(i) != Aov::kSeconds) aovs.push_back(Aov(i));
  }
  return aovs;
}

RenderSettings settings_of(float noise, std::uint32_t spp) {
  RenderSettings settings{.width = kWidth, .height = kHeight, .spp = spp, .max_bounces = 2, .build = {}};
  settings.noise = {noise, 32};
  return settings;
}

std::uint32_t samples_of(const Image& image, std::size_t pixel) {
  return static_cast<std::uint32_t>(layer_of(image, Aov::kSampleCount).values[pixel]);
}

bool same_pixel(const Image& a, const Image& b, std::size_t pixel) {
  if (!std::equal(&a.rgba[4 * pixel], &a.rgba[4 * pixel] + 4, &b.rgba[4 * pixel])) return false;
  for (std::size_t i = 0; i < a.aovs.size(); ++i) {
    const std::size_t numbers = form_of(a.aovs[i].aov).numbers;
    if (form_of(a.aovs[i].aov).is_id
            ? a.aovs[i].ids[pixel] != b.aovs[i].ids[pixel]
            : !std::equal(&a.aovs[i].values[numbers * pixel], &a.aovs[i].values[numbers * pixel] + numbers,
                          &b.aovs[i].values[numbers * pixel]))
      return false;
  }
  return true;
}

TEST_CASE("each pixel, with all of its AOVs, is that of a picture of as many samples of every pixel") {
  const Scene scene = cube_over_floor(kWidth, kHeight);
  RenderSettings settings = settings_of(0.03f, 200);
  settings.aovs = all_that_repeat();
  const Image image = render(scene, settings);
  std::map<std::uint32_t, std::vector<std::size_t>> by_samples;
  for (std::size_t pixel = 0; pixel < kWidth * kHeight; ++pixel)
    by_samples[samples_of(image, pixel)].push_back(pixel);
  CHECK(by_samples.size() >= 3);
  CHECK(by_samples.begin()->first == 32);
  CHECK(by_samples.rbegin()->first <= 200);
  settings.noise = {};
  for (const auto& [samples, pixels] : by_samples) {
    CAPTURE(samples);
    if (samples != 200) CHECK(samples % kBlockSamples == 0);
    settings.spp = samples;
    const Image even = render(scene, settings);
    for (const std::size_t pixel : pixels) {
      CAPTURE(pixel);
      CHECK(same_pixel(image, even, pixel));
    }
  }
}

TEST_CASE("neither threads nor batches nor AOVs change a bit or a sample") {
  const Scene scene = cube_over_floor(kWidth, kHeight);
  RenderSettings settings = settings_of(0.05f, 256);
  const Image first = render(scene, settings);
  for (const auto& [threads, batch] : {std::pair{1u, 4096u}, {3u, 4096u}, {2u, 100u}, {1u, 16u}}) {
    settings.threads = threads;
    settings.batch_paths = batch;
    CHECK(render(scene, settings).rgba == first.rgba);
  }
  settings.aovs = {Aov::kSampleCount, Aov::kSeconds};
  CHECK(render(scene, settings).rgba == first.rgba);
}

TEST_CASE("more noise, no more samples; the least and the most are kept; figures count what was taken") {
  const Scene scene = cube_over_floor(kWidth, kHeight);
  std::vector<double> counts;
  for (const auto& [noise, least, most] : {std::tuple{0.2f, 32u, 512u},
                                           {0.05f, 32u, 512u},
                                           {0.02f, 32u, 512u},
                                           {0.2f, 100u, 512u},
                                           {1e-6f, 32u, 40u},
                                           {0.2f, 64u, 48u}}) {
    RenderSettings settings = settings_of(noise, most);
    settings.noise.min_spp = least;
    settings.aovs = {Aov::kSampleCount};
    Renderer renderer;
    renderer.commit(std::make_shared<Scene>(scene), settings);
    const Image image = renderer.render();
    const std::vector<float>& samples = layer_of(image, Aov::kSampleCount).values;
    CHECK(*std::ranges::min_element(samples) >= float(std::min(least, most)));
    CHECK(*std::ranges::max_element(samples) <= float(most));
    double all = 0.0;
    for (const float each : samples) all += each;
    CHECK(double(renderer.statistics().camera_rays) == all);
    CHECK(renderer.statistics().spp == most);
    counts.push_back(all);
  }
  CHECK(counts[0] < counts[1]);
  CHECK(counts[1] < counts[2]);
  CHECK(counts[3] >= 128.0 * kWidth * kHeight);
  CHECK(counts[5] == 48.0 * kWidth * kHeight);  // all have the most before anybody looks
}

// Of a stripe, which the camera's light meets less squarely away from the middle: by a picture of it alone.
double shine(std::size_t pixel) {
  static const Image full =
      render(stripes(kSize, kSize, 0.3f),
             {.width = kSize, .height = kSize, .spp = 4096, .max_bounces = 0, .build = {}});
  return double(full.rgba[4 * pixel]) / double(full.rgba[4 * pixel + 3]);
}

// Pixels' errors against what they should be, over seeds: root of the mean square, mean, and samples a pixel.
struct Errors {
  double rms = 0.0, bias = 0.0, samples = 0.0;
};
Errors errors_of(float share, Sampling sampling, float noise, std::uint32_t seeds, std::uint32_t most) {
  Errors errors;
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    RenderSettings settings{.width = kSize, .height = kSize, .spp = most, .max_bounces = 0, .build = {}};
    settings.noise = {noise, 32};
    settings.sampling = sampling;
    settings.seed = seed;
    settings.aovs = {Aov::kSampleCount};
    const Image image = render(stripes(kSize, kSize, share), settings);
    for (std::size_t pixel = 0; pixel < kSize * kSize; ++pixel) {
      const double error = double(image.rgba[4 * pixel]) / (share * shine(pixel)) - 1.0;
      errors.rms += error * error;
      errors.bias += error;
      errors.samples += samples_of(image, pixel);
    }
  }
  const double count = double(seeds) * kSize * kSize;
  return {std::sqrt(errors.rms / count), errors.bias / count, errors.samples / count};
}

TEST_CASE("errors are what was asked for: independent samples of a pixel of a known value") {
  for (const float noise : {0.1f, 0.05f}) {
    const Errors found = errors_of(0.3f, Sampling::kIndependent, noise, 4, 4096);
    CAPTURE(found.samples);
    CAPTURE(found.rms);
    CHECK(found.rms < 1.05 * noise);
    CHECK(found.rms > 0.5 * noise);
  }
}

TEST_CASE("points that lie well apart end sooner, with no more error") {
  const Errors found = errors_of(0.3f, Sampling::kSobol, 0.05f, 4, 4096);
  const Errors independent = errors_of(0.3f, Sampling::kIndependent, 0.05f, 1, 4096);
  CHECK(found.rms < 0.05);
  CHECK(found.samples < 0.25 * independent.samples);
}

// docs/design/noise.md states these figures.
TEST_CASE("soak: to stop on what was seen biases by no more than is stated" * doctest::test_suite("slow")) {
  const auto seeds = static_cast<std::uint32_t>(test::soak_count(8, 400));
  for (const auto& [share, noise, most] :
       {std::tuple{0.3f, 0.2f, 0.003}, {0.3f, 0.1f, 0.001}, {0.05f, 0.1f, 0.001}}) {
    const Errors found = errors_of(share, Sampling::kIndependent, noise, seeds, 16384);
    const double chance = 3.0 * found.rms / std::sqrt(double(kSize * kSize * seeds));
    std::ostringstream figure;
    figure << "of " << share << " of the pixel, to " << noise << ": " << found.bias
           << " of its value, within " << chance << "; error " << found.rms << ", samples " << found.samples;
    CAPTURE(figure.str());
    CHECK(std::abs(found.bias) < most + chance);
    test::soak_figure("bias of noise that ends", figure.str());
  }
}

TEST_CASE("slices of the shutter sum up to the picture whatever pixels take") {
  RenderSettings settings = settings_of(0.05f, 256);
  settings.film.shutter_slices = 4;
  const Image image = render(cube_over_floor(kWidth, kHeight), settings);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    float sum = 0.0f;
    for (std::size_t slice = 0; slice < 4; ++slice) sum += image.slices[slice * image.rgba.size() + i];
    CHECK(sum == doctest::Approx(image.rgba[i]).epsilon(1e-5));
  }
}

TEST_CASE("settings that make no sense are refused by name") {
  const auto refused = [](const auto& change, const char* name) {
    RenderSettings settings = settings_of(0.0f, 4);
    change(settings);
    Renderer renderer;
    CHECK_THROWS_WITH_AS(renderer.commit(std::make_shared<Scene>(stripes(2, 2, 0.5f)), settings),
                         doctest::Contains(name), Error);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  refused([&](RenderSettings& s) { s.noise.target = nan; }, "noise: found nan");
  refused([](RenderSettings& s) { s.noise.target = -0.1f; }, "noise: found -0.1");
  refused([](RenderSettings& s) { s.noise.min_spp = 0; }, "min_spp: found 0");
  refused([&](RenderSettings& s) { s.clamp_indirect = nan; }, "clamp_indirect: found nan");
  refused([](RenderSettings& s) { s.clamp_indirect = -1.0f; }, "clamp_indirect: found -1");
  refused([](RenderSettings& s) { s.texture_rate = 0.0f; }, "texture_rate: found 0");
}

}  // namespace
}  // namespace msbvh
