#include <array>
#include <cmath>
#include <cstddef>
#include <doctest/doctest.h>
#include <set>
#include <vector>

#include "core/integrate/sampler.h"

namespace msbvh {
namespace {

// The second Sobol' dimension as Burley 2020 has it, by its direction numbers.
std::uint32_t sobol_by_direction_numbers(std::uint32_t index) {
  std::uint32_t direction = 1u << 31, result = 0;
  for (; index != 0; index >>= 1) {
    if (index & 1) result ^= direction;
    direction ^= direction >> 1;
  }
  return result;
}

// The third one by Joe and Kuo's parameters: degree 2, a = 1, m = 1, 3.
std::uint32_t third_by_direction_numbers(std::uint32_t index) {
  std::uint32_t m[32] = {1, 3}, result = 0;
  for (int k = 2; k < 32; ++k) m[k] = 2 * m[k - 1] ^ 4 * m[k - 2] ^ m[k - 2];
  for (int k = 0; index != 0; ++k, index >>= 1) {
    if (index & 1) result ^= m[k] << (31 - k);
  }
  return result;
}

// Whether 2^m points lie one in each of the 2^m elementary boxes of every shape 2^-a x 2^-b x ...
template <std::size_t kDimensions>
bool is_net(const std::vector<std::array<float, kDimensions>>& points, int m,
            std::array<int, kDimensions> shape, std::size_t dimension, int left) {
  if (dimension + 1 < kDimensions) {
    for (int bits = 0; bits <= left; ++bits) {
      shape[dimension] = bits;
      if (!is_net(points, m, shape, dimension + 1, left - bits)) return false;
    }
    return true;
  }
  shape[dimension] = left;
  std::set<std::array<int, kDimensions>> cells;
  for (const auto& point : points) {
    std::array<int, kDimensions> cell;
    for (std::size_t d = 0; d < kDimensions; ++d) {
      cell[d] = static_cast<int>(std::ldexp(point[d], shape[d]));
    }
    cells.insert(cell);
  }
  return cells.size() == points.size();
}
template <std::size_t kDimensions>
bool is_net(const std::vector<std::array<float, kDimensions>>& points, int m) {
  REQUIRE(points.size() == std::size_t(1) << m);
  return is_net(points, m, {}, 0, m);
}

TEST_CASE("Sobol' dimensions two and three equal their direction numbers") {
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const std::uint32_t index = i < 50000 ? i : hash(i);
    REQUIRE(sobol::reverse_bits(sobol::pascal(index)) == sobol_by_direction_numbers(index));
    REQUIRE(sobol::reverse_bits(sobol::third(index)) == third_by_direction_numbers(index));
  }
}

TEST_CASE("every named pair is a (0,m,2)-net in every pixel") {
  constexpr int kM = 8;
  for (std::uint32_t pixel = 0; pixel < 8; ++pixel) {
    for (const Dimension dimension : {Dimension::kOpacity, Dimension::kLight, Dimension::kBounce}) {
      std::vector<std::array<float, 2>> points;
      for (std::uint32_t s = 0; s < 1u << kM; ++s) {
        const Point2 p = Sampler(PixelSampler(7, pixel, 3), s).pair(dimension, 1, 2);
        points.push_back({p.x, p.y});
      }
      CHECK(is_net(points, kM));
    }
  }
}

// Any aligned run of 2^m samples, so that blocks of samples are as good as the first ones.
TEST_CASE("position in the pixel is a (0,m,2)-net, and time is stratified, in every aligned block") {
  constexpr int kM = 6;
  for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
    const PixelSampler sampler(1, pixel, 5);
    const std::uint32_t first = (pixel % 8) << kM;
    std::vector<std::array<float, 2>> points;
    std::set<int> strata;
    for (std::uint32_t s = first; s < first + (1u << kM); ++s) {
      const Point2 p = sampler.position(s);
      points.push_back({p.x, p.y});
      strata.insert(static_cast<int>(sampler.time(s) * (1 << kM)));
    }
    CHECK(is_net(points, kM));
    CHECK(strata.size() == std::size_t(1) << kM);
  }
}

TEST_CASE("numbers and times lie in [0, 1)") {
  CHECK(sobol::to_unit_float(0xffffffffu) < 1.0f);
  for (std::uint32_t s = 0; s < 100000; ++s) {
    const float time = PixelSampler(s, 0, 0).time(999 + s);
    CHECK(time >= 0.0f);
    CHECK(time < 1.0f);
  }
}

// Pairs of different names, depths or lights, drawn for the same sample, must not be correlated: across
// pixels the mean of the product of two centred uniform numbers is 0 with the standard deviation 1/12 /
// sqrt(n). A function, not a lambda: a lambda is constexpr by default, and compilers would evaluate it.
struct Draw {
  PixelSampler pixel;
  Sampler sampler;
  std::uint32_t sample;
};

template <typename First, typename Second>
double correlation(First first, Second second) {
  constexpr int kPixels = 1 << 18;
  double sum = 0;
  for (int i = 0; i < kPixels; ++i) {
    const PixelSampler pixel(0, i % 512, i / 512);
    const Draw a{pixel, Sampler(pixel, i % 16), static_cast<std::uint32_t>(i % 16)};
    sum += (first(a) - 0.5) * (second(a) - 0.5);
  }
  return sum / kPixels * 12 * std::sqrt(double(kPixels));  // in standard deviations
}

TEST_CASE("names, depths, lights and pixels are independent") {
  const auto light = [](const Draw& d) { return d.sampler.pair(Dimension::kLight, 0).x; };
  CHECK(std::abs(correlation(light, [](const Draw& d) { return d.sampler.pair(Dimension::kLight, 0).y; })) <
        4.5);
  CHECK(std::abs(correlation(light, [](const Draw& d) { return d.sampler.pair(Dimension::kBounce, 0).x; })) <
        4.5);
  CHECK(std::abs(correlation(light, [](const Draw& d) { return d.sampler.pair(Dimension::kLight, 1).x; })) <
        4.5);
  CHECK(std::abs(correlation(light,
                             [](const Draw& d) { return d.sampler.pair(Dimension::kLight, 0, 1).x; })) < 4.5);
  CHECK(std::abs(correlation(light, [](const Draw& d) { return d.pixel.position(d.sample).x; })) < 4.5);
  CHECK(std::abs(correlation(light, [](const Draw& d) { return d.pixel.time(d.sample); })) < 4.5);
  const auto x = [](const Draw& d) { return d.pixel.position(d.sample).x; };
  CHECK(std::abs(correlation(x, [](const Draw& d) { return d.pixel.time(d.sample); })) < 4.5);
}

TEST_CASE("seeds and pixels change the numbers, and nothing else does") {
  const auto draw = [](std::uint32_t seed, std::uint32_t x, std::uint32_t y) {
    return Sampler(PixelSampler(seed, x, y), 3).pair(Dimension::kBounce, 2).x;
  };
  CHECK(draw(1, 2, 3) == draw(1, 2, 3));
  CHECK(draw(1, 2, 3) != draw(2, 2, 3));
  CHECK(draw(1, 2, 3) != draw(1, 3, 2));
}

}  // namespace
}  // namespace msbvh
