#include "core/film/pixel_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace msbvh {
namespace {

// Between which a smooth filter is taken as linear: within 1e-4 of its largest value.
constexpr int kSmoothPieces = 256;

int pieces(FilterShape shape) {
  if (shape == FilterShape::kBox) return 1;
  return shape == FilterShape::kTriangle ? 2 : kSmoothPieces;
}

}  // namespace

double filter_weight(FilterShape shape, double r) {
  const double phase = std::numbers::pi * (r + 1.0);
  switch (shape) {
    case FilterShape::kBox:
      return 1.0;
    case FilterShape::kTriangle:
      return 1.0 - std::abs(r);
    case FilterShape::kGaussian:
      return std::exp(-2.0 * r * r);
    case FilterShape::kBlackmanHarris:
      return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2.0 * phase) -
             0.01168 * std::cos(3.0 * phase);
  }
  return 0.0;
}

FilterSampler::FilterSampler(const PixelFilter& filter) {
  if (filter.is_pixel()) return;
  const int count = pieces(filter.shape);
  std::vector<Knot> knots;
  for (int i = 0; i <= count; ++i) {
    const double r = 2.0 * i / count - 1.0;
    knots.push_back({static_cast<float>(0.5 * r * filter.width),
                     static_cast<float>(std::max(0.0, filter_weight(filter.shape, r)))});
  }
  offset_ = PiecewiseLinear(knots);
}

}  // namespace msbvh
