// Indirect light that is cut off: of each sample, and of nothing else.
#include "tests/render/noisy_scenes.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 24;

// One sample a pixel, so that pixels are samples.
Image with_clamp(float most, std::uint32_t bounces = 3) {
  return render(cube_over_floor(kSize, kSize),
                {.width = kSize,
                 .height = kSize,
                 .spp = 1,
                 .max_bounces = bounces,
                 .clamp_indirect = most,
                 .aovs = {Aov::kIndirectDiffuse, Aov::kDirectDiffuse, Aov::kEmission},
                 .build = {}});
}

float largest(const std::vector<float>& values) { return *std::ranges::max_element(values); }

TEST_CASE("no sample has more indirect light than is asked for, and all else keeps its bits") {
  const Image free = with_clamp(0.0f), clamped = with_clamp(0.05f);
  const auto values = [](const Image& image, Aov aov) { return layer_of(image, aov).values; };
  CHECK(largest(values(free, Aov::kIndirectDiffuse)) > 0.1f);
  CHECK(largest(values(clamped, Aov::kIndirectDiffuse)) <= doctest::Approx(0.05f));
  CHECK(values(clamped, Aov::kDirectDiffuse) == values(free, Aov::kDirectDiffuse));
  CHECK(values(clamped, Aov::kEmission) == values(free, Aov::kEmission));
  for (std::size_t i = 0; i < free.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    const std::size_t at = i / 4 * 3 + i % 4;
    const float parts = values(clamped, Aov::kDirectDiffuse)[at] +
                        values(clamped, Aov::kIndirectDiffuse)[at] + values(clamped, Aov::kEmission)[at];
    CHECK(clamped.rgba[i] == doctest::Approx(parts).epsilon(1e-5));
  }
}

TEST_CASE("where less than the most arrives, or nothing indirect at all, no bit changes") {
  CHECK(with_clamp(1e5f).rgba == with_clamp(0.0f).rgba);
  CHECK(with_clamp(1e-3f, 0).rgba == with_clamp(0.0f, 0).rgba);
}

}  // namespace
}  // namespace msbvh
