// Places in the pixel and times in the shutter, as filters and curves draw them.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <random>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/film/film_settings.h"

namespace msbvh {
namespace {

constexpr int kBins = 64;
constexpr std::size_t kDraws = 400'000;

// Pearson's statistic of draws in [0, 1] against the expected share of each bin. Its mean is kBins - 1 where
// they agree, its standard deviation about sqrt(2 kBins); bins that expect next to nothing are pooled.
template <typename Draw, typename Share>
double chi_square(const Draw& draw, const Share& share_below) {
  std::vector<double> found(kBins, 0.0);
  for (std::size_t i = 0; i < kDraws; ++i) ++found[std::min(kBins - 1, int(draw() * kBins))];
  double statistic = 0.0, pooled_found = 0.0, pooled = 0.0;
  for (int b = 0; b < kBins; ++b) {
    pooled_found += found[std::size_t(b)];
    pooled += double(kDraws) * (share_below(double(b + 1) / kBins) - share_below(double(b) / kBins));
    if (pooled < 10.0) continue;
    statistic += (pooled_found - pooled) * (pooled_found - pooled) / pooled;
    pooled_found = pooled = 0.0;
  }
  return statistic;
}
// A chance of 1e-6 with 63 degrees of freedom (Wilson and Hilferty's approximation).
constexpr double kTooFar = 129.0;

// The share of a filter below a place, by the midpoint rule.
double filter_share(FilterShape shape, double place01) {
  constexpr int kSteps = 4096;
  double below = 0.0, all = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) / kSteps, weight = filter_weight(shape, 2.0 * x - 1.0);
    all += weight;
    if (x < place01) below += weight;
  }
  return below / all;
}

TEST_CASE("places are spread as each filter weighs them, in x and in y") {
  for (const FilterName& filter : kFilters) {
    for (const float width : {filter.width, 0.5f, kMostFilterWidth}) {
      if (PixelFilter{filter.shape, width}.is_pixel()) continue;
      CAPTURE(filter.name);
      CAPTURE(width);
      const FilterSampler sampler({filter.shape, width});
      std::mt19937 random(7);
      std::uniform_real_distribution<float> even(0.0f, 1.0f);
      const auto share = [&](double x) { return filter_share(filter.shape, x); };
      const auto place01 = [&](float place) { return (double(place) - 0.5) / double(width) + 0.5; };
      CHECK(chi_square([&] { return place01(sampler({even(random), 0.5f}).x); }, share) < kTooFar);
      CHECK(chi_square([&] { return place01(sampler({0.5f, even(random)}).y); }, share) < kTooFar);
    }
  }
}

TEST_CASE("the wrong filter is found out") {
  const FilterSampler triangle({FilterShape::kTriangle, 2.0f});
  std::mt19937 random(7);
  std::uniform_real_distribution<float> even(0.0f, 1.0f);
  const auto share = [&](double x) { return filter_share(FilterShape::kGaussian, x); };
  CHECK(chi_square([&] { return double(triangle({even(random), 0.5f}).x) / 2.0 + 0.25; }, share) > kTooFar);
}

TEST_CASE("filters are even, reach from edge to edge and have no negative weight") {
  for (const FilterName& filter : kFilters) {
    CAPTURE(filter.name);
    CHECK(filter_weight(filter.shape, 0.0) == doctest::Approx(1.0).epsilon(1e-4));
    for (double r = 0.0; r <= 1.0; r += 1.0 / 64) {
      CHECK(filter_weight(filter.shape, r) == doctest::Approx(filter_weight(filter.shape, -r)).epsilon(1e-9));
      CHECK(filter_weight(filter.shape, r) >= 0.0);
    }
    const FilterSampler sampler({filter.shape, 3.0f});
    CHECK(sampler({0.0f, 0.0f}).x == doctest::Approx(-1.0));
    CHECK(sampler({0x1.fffffep-1f, 0.0f}).x <= 2.0f);
    CHECK(sampler({0.5f, 0.5f}).y == doctest::Approx(0.5));
  }
}

TEST_CASE("a box of one pixel is the pixel to the bit") {
  const FilterSampler sampler{PixelFilter{}};
  for (const float u : {0.0f, 0.1f, 0x1.fffffep-1f}) CHECK(sampler({u, u}).x == u);
}

const ShutterCurve kSteps{{0.125f, 0.0f}, {0.125f, 2.0f}, {0.5f, 2.0f}, {0.5f, 0.5f}, {1.0f, 0.5f}};

TEST_CASE("times are spread as each curve weighs them") {
  for (const ShutterCurve& curve : {triangle_curve(), trapezoid_curve(), kSteps}) {
    const ShutterSampler shutter(curve, {});
    std::mt19937 random(9);
    std::uniform_real_distribution<float> even(0.0f, 1.0f);
    const double all = integral(curve, 0.0, 1.0);
    CHECK(chi_square([&] { return double(shutter(even(random), 0.0f)); },
                     [&](double t) { return integral(curve, 0.0, t) / all; }) < kTooFar);
  }
}

TEST_CASE("curves keep the order of times, and all lie below 1") {
  for (const ShutterCurve& curve : {box_curve(), triangle_curve(), trapezoid_curve(), kSteps}) {
    const ShutterSampler shutter(curve, {});
    float last = 0.0f;
    for (int i = 0; i <= 4096; ++i) {
      const float time = shutter(std::min(float(i) / 4096.0f, 0x1.fffffep-1f), 0.0f);
      CHECK(time >= last);
      CHECK(time < 1.0f);
      last = time;
    }
  }
  CHECK(ShutterSampler(triangle_curve(), {})(0.5f, 0.0f) == 0.5f);
  CHECK(ShutterSampler(box_curve(), {})(0.3f, 0.7f) == 0.3f);
  CHECK(ShutterSampler(box_curve(), {}).is_box());
}

TEST_CASE("a rolling shutter exposes each row for a part of the time, later down the picture") {
  const ShutterSampler shutter(box_curve(), {.share = 0.75f});
  CHECK(shutter(0.0f, 0.0f) == 0.0f);
  CHECK(shutter(0.0f, 1.0f) == 0.75f);
  CHECK(shutter(0.5f, 0.5f) == doctest::Approx(0.375 + 0.125));
  CHECK(shutter(0x1.fffffep-1f, 1.0f) < 1.0f);
  const ShutterSampler scan(box_curve(), {.share = 1.0f});
  CHECK(scan(0.9f, 0.25f) == 0.25f);
  const ShutterSampler crop(box_curve(), {.share = 1.0f, .top = 0.5f, .height = 0.25f});
  CHECK(crop(0.0f, 0.5f) == 0.625f);
}

TEST_CASE("integrals of curves are exact from anywhere to anywhere") {
  CHECK(integral(triangle_curve(), 0.0, 1.0) == doctest::Approx(0.5));
  CHECK(integral(triangle_curve(), 0.25, 0.5) == doctest::Approx(0.1875));
  CHECK(integral(kSteps, 0.25, 0.75) == doctest::Approx(0.25 * 2 + 0.25 * 0.5));
  CHECK(integral(kSteps, -1.0, 0.125) == 0.0);
}

TEST_CASE("settings that make no sense are named") {
  const auto why = [](const FilmSettings& settings) -> std::string {
    try {
      check(settings);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  CHECK(why({}) == "");
  CHECK(why({.filter = {FilterShape::kGaussian, 0.0f}}).find("filter width: found 0") != std::string::npos);
  CHECK(why({.filter = {FilterShape::kBox, 4.5f}}).find("at most 4 pixels") != std::string::npos);
  CHECK(why({.filter = {FilterShape::kBox, NAN}}).find("filter width: found nan") != std::string::npos);
  for (const ShutterCurve& curve :
       {ShutterCurve{{0.0f, 1.0f}}, ShutterCurve{{0.0f, 0.0f}, {1.0f, 0.0f}},
        ShutterCurve{{0.5f, 1.0f}, {0.25f, 1.0f}}, ShutterCurve{{0.0f, -1.0f}, {1.0f, 3.0f}},
        ShutterCurve{{0.0f, INFINITY}, {1.0f, 1.0f}}})
    CHECK(why({.shutter_curve = curve}).find("no density") != std::string::npos);
  CHECK(why({.shutter_curve = {{0.0f, 1.0f}, {1.5f, 1.0f}}}).find("times beyond the shutter") !=
        std::string::npos);
  CHECK(why({.rolling = {.share = 1.5f}}).find("rolling shutter: found 1.5") != std::string::npos);
}

}  // namespace
}  // namespace msbvh
