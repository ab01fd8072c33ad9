// Textures of one channel: the bilinear value between texels, means over footprints, and what lies outside.
#include <cmath>
#include <doctest/doctest.h>
#include <utility>
#include <vector>

#include "delegate/translate/look/scalar_texture.h"

using namespace msbvh::translate;

namespace {

// The value of a texel is `value(column, row)`, rows counted from the top.
template <typename Value>
ScalarImage image(std::uint32_t width, std::uint32_t height, const Value& value) {
  ScalarImage result{width, height};
  for (std::uint32_t r = 0; r < height; ++r) {
    for (std::uint32_t c = 0; c < width; ++c) result.values.push_back(float(value(c, r)));
  }
  return result;
}

ScalarTexture texture(ScalarImage of, Wrap wrap) { return ScalarTexture(std::move(of), wrap, wrap); }

double column_of(std::uint32_t c, std::uint32_t) { return c; }

}  // namespace

TEST_CASE("a texel's middle has its value, the picture's lower left is (0, 0)") {
  const ScalarTexture t = texture(image(4, 3, [](auto c, auto r) { return 10.0 * r + c; }), Wrap::kClamp);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c)
      CHECK(t.at((c + 0.5) / 4, 1.0 - (r + 0.5) / 3, 0, 0) == doctest::Approx(10.0 * r + c));
  }
  CHECK(t.at(0, 0, 0, 0) == doctest::Approx(20.0));
  CHECK(t.at(1, 1, 0, 0) == doctest::Approx(3.0));
}

TEST_CASE("a ramp is a ramp between texels, and stays one under a filter") {
  const ScalarTexture t = texture(image(64, 64, column_of), Wrap::kClamp);
  for (const double size : {0.0, 1.0 / 64, 1.7 / 64, 4.0 / 64, 9.0 / 64}) {
    for (double s = 0.25; s < 0.75; s += 0.013) {
      CAPTURE(size);
      CHECK(t.at(s, 0.4, size, 0.5 * size) == doctest::Approx(64 * s - 0.5).epsilon(1e-5));
    }
  }
}

TEST_CASE("the mean over all of a picture of any size is that of its texels") {
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {16, 3}, {31, 33}, {100, 1}}) {
    double sum = 0.0;
    const auto value = [](auto c, auto r) { return std::sin(3.7 * c + 1.3 * r); };
    const ScalarImage made = image(std::uint32_t(width), std::uint32_t(height), value);
    for (const float v : made.values) sum += v;
    const ScalarTexture t = texture(made, Wrap::kRepeat);
    CAPTURE(width);
    CHECK(t.at(0.3, 0.6, 2.0, 2.0) == doctest::Approx(sum / (width * height)).epsilon(1e-5));
  }
}

TEST_CASE("noise gets quieter with a larger footprint") {
  const auto noise = [](std::uint32_t c, std::uint32_t r) {
    return std::fmod(std::abs(std::sin(c * 12.9898 + r * 78.233)) * 43758.5453, 1.0);
  };
  const ScalarTexture t = texture(image(256, 256, noise), Wrap::kRepeat);
  const auto spread = [&](double texels) {
    double sum = 0.0;
    for (int i = 0; i < 400; ++i) {
      const double v = t.at(0.0137 * i, 0.0271 * i, texels / 256, texels / 256) - 0.5;
      sum += v * v;
    }
    return std::sqrt(sum / 400);
  };
  CHECK(spread(8) < 0.5 * spread(1));
  CHECK(spread(64) < 0.5 * spread(8));
}

TEST_CASE("modes say what is outside of the picture") {
  const auto at = [](Wrap wrap, double s) { return texture(image(4, 1, column_of), wrap).at(s, 0.5, 0, 0); };
  CHECK(at(Wrap::kClamp, -3.0) == 0.0);
  CHECK(at(Wrap::kClamp, 3.0) == 3.0);
  CHECK(at(Wrap::kRepeat, 2.375) == doctest::Approx(1.0));
  CHECK(at(Wrap::kRepeat, -0.125) == doctest::Approx(3.0));
  CHECK(at(Wrap::kRepeat, 0.0) == doctest::Approx(1.5));  // between the last and the first
  CHECK(at(Wrap::kMirror, 1.125) == doctest::Approx(3.0));
  CHECK(at(Wrap::kMirror, -0.375) == doctest::Approx(1.0));
  CHECK(at(Wrap::kBlack, 1.001) == 0.0);
  CHECK(at(Wrap::kBlack, -0.001) == 0.0);
  CHECK(at(Wrap::kBlack, 1.0) == 3.0);  // its edge belongs to the picture
  CHECK(at(Wrap::kRepeat, std::nan("")) == 0.0);
}

TEST_CASE("nothing is read beyond the least and the largest") {
  const ScalarTexture inside(image(3, 1, [](auto c, auto) { return 2.0 + c; }), Wrap::kClamp, Wrap::kClamp);
  CHECK(inside.least() == 2.0);
  CHECK(inside.largest() == 4.0);
  const ScalarTexture black(image(3, 1, [](auto c, auto) { return 2.0 + c; }), Wrap::kBlack, Wrap::kClamp);
  CHECK(black.least() == 0.0);
}
