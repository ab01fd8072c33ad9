#include "core/film/piecewise_linear.h"

#include <algorithm>
#include <cmath>

namespace msbvh {

bool is_density(std::span<const Knot> knots) {
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i].place) || !std::isfinite(knots[i].weight) || knots[i].weight < 0.0f)
      return false;
    if (i > 0 && knots[i].place < knots[i - 1].place) return false;
  }
  return !PiecewiseLinear(knots).empty();
}

double integral(std::span<const Knot> knots, double begin, double end) {
  double sum = 0.0;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double p0 = knots[i - 1].place, p1 = knots[i].place;
    const double a = std::clamp(begin, p0, p1), b = std::clamp(end, p0, p1);
    if (!(b > a)) continue;
    const double middle = ((a + b) * 0.5 - p0) / (p1 - p0);
    sum += (b - a) * std::lerp(double(knots[i - 1].weight), double(knots[i].weight), middle);
  }
  return sum;
}

PiecewiseLinear::PiecewiseLinear(std::span<const Knot> knots) {
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double begin = knots[i - 1].place, length = double(knots[i].place) - begin;
    const double w0 = knots[i - 1].weight, w1 = knots[i].weight, area = length * 0.5 * (w0 + w1);
    if (!(area > 0.0)) continue;
    pieces_.push_back({begin, length, w0, w1, area_});
    area_ += area;
  }
}

double PiecewiseLinear::sample(double u) const {
  const double wanted = u * area_;
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), wanted,
                                      [](double area, const Piece& p) { return area < p.area_before; });
  const Piece& p = after == pieces_.begin() ? pieces_.front() : *(after - 1);
  // The root of w0 x + (w1 - w0) x^2 / (2 length) = area that loses no digits where the density is even.
  const double area = std::max(0.0, wanted - p.area_before);
  const double under = p.w0 * p.w0 + 2.0 * (p.w1 - p.w0) * area / p.length;
  const double x = 2.0 * area / (p.w0 + std::sqrt(std::max(0.0, under)));
  return p.begin + std::clamp(area > 0.0 ? x : 0.0, 0.0, p.length);
}

}  // namespace msbvh
