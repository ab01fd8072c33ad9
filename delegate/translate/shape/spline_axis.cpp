#include "delegate/translate/shape/spline_axis.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

bool check_sizes(const SplineInput& input, PrimLog& log) {
  if (input.order < 2 || input.order > SplineAxis::kMostOrder) {
    return log.reject(input.name + "Order",
                      message("found ", input.order, "; expected 2 to ", SplineAxis::kMostOrder));
  }
  if (input.vertex_count < input.order) {
    return log.reject(input.name + "VertexCount", message("found ", input.vertex_count, "; expected ",
                                                          input.order, ", the order, or more"));
  }
  const std::size_t expected = std::size_t(input.vertex_count) + std::size_t(input.order);
  if (input.knots.size() == expected) return true;
  return log.reject(input.name + "Knots", message("found ", input.knots.size(), " knots; expected ", expected,
                                                  ", the vertex count and the order"));
}

bool check_knots(const SplineInput& input, PrimLog& log) {
  const std::string attribute = input.name + "Knots";
  for (std::size_t i = 0; i < input.knots.size(); ++i) {
    if (!std::isfinite(input.knots[i])) {
      return log.reject(attribute, message("knot ", i, " is ", input.knots[i], "; expected a finite number"));
    }
    if (i > 0 && input.knots[i] < input.knots[i - 1]) {
      return log.reject(attribute,
                        message("knot ", i, " is ", input.knots[i], ", less than ", input.knots[i - 1],
                                " before it; expected knots that do not "
                                "decrease"));
    }
  }
  const double first = input.knots[std::size_t(input.order) - 1];
  const double last = input.knots[std::size_t(input.vertex_count)];
  if (first < last) return true;
  return log.reject(attribute, message("knots ", input.order - 1, " and ", input.vertex_count, " are both ",
                                       first, "; expected different ones: what is drawn lies between them"));
}

// The range that is drawn: what is authored, as far as there is a surface.
std::optional<std::array<double, 2>> drawn_range(const SplineInput& input, PrimLog& log) {
  const double first = input.knots[std::size_t(input.order) - 1];
  const double last = input.knots[std::size_t(input.vertex_count)];
  if (!input.range) return std::array{first, last};
  const auto [begin, end] = *input.range;
  const double from = std::max(begin, first), to = std::min(end, last);
  if (!(begin < end) || !(from < to)) {
    log.reject(input.name + "Range", message("found (", begin, ", ", end, "); expected a part of (", first,
                                             ", ", last, "), where the knots have a spline"));
    return std::nullopt;
  }
  if (begin < first || end > last) {
    log.warn(input.name + "Range", message("found (", begin, ", ", end, "); expected a part of (", first,
                                           ", ", last, "), where the knots have a spline; drew that"));
  }
  return std::array{from, to};
}

}  // namespace

std::optional<SplineAxis> SplineAxis::make(const SplineInput& input, PrimLog& log) {
  if (!check_sizes(input, log) || !check_knots(input, log)) return std::nullopt;
  const std::optional<std::array<double, 2>> range = drawn_range(input, log);
  if (!range) return std::nullopt;
  return SplineAxis(input, (*range)[0], (*range)[1]);
}

SplineAxis::SplineAxis(const SplineInput& input, double begin, double end)
    : vertex_count_(std::uint32_t(input.vertex_count)),
      order_(std::uint32_t(input.order)),
      knots_(input.knots.begin(), input.knots.end()) {
  std::uint32_t last_end = 0;  // the knot where the span before ends
  for (std::uint32_t i = order_ - 1; i < vertex_count_; ++i) {
    const double from = std::max(knots_[i], begin), to = std::min(knots_[i + 1], end);
    if (!(from < to)) continue;
    const std::uint32_t repeats = spans_.empty() ? 0 : i - last_end + 1;
    spans_.push_back({from, to, knots_[i], knots_[i + 1], i + 1 - order_, i + 1 - order_, repeats});
    last_end = i + 1;
  }
}

// Algorithm A2.2, and the derivatives by the basis of one degree less (equation 2.7).
SplineAxis::Basis SplineAxis::basis(const SplineSpan& span, double parameter) const {
  const std::uint32_t degree = order_ - 1, at = span.first_control + degree;
  Basis result{std::vector<double>(order_, 0.0), std::vector<double>(order_, 0.0)};
  std::vector<double>& values = result.values;
  values[0] = 1.0;
  for (std::uint32_t p = 1; p <= degree; ++p) {
    if (p == degree) {
      for (std::uint32_t r = 0; r < degree; ++r) {
        const double width = knots_[at + r + 1] - knots_[at + r + 1 - degree];
        const double slope = degree * values[r] / width;
        result.derivatives[r] -= slope;
        result.derivatives[r + 1] += slope;
      }
    }
    double carried = 0.0;
    for (std::uint32_t r = 0; r < p; ++r) {
      const double right = knots_[at + r + 1] - parameter, left = parameter - knots_[at + r + 1 - p];
      const double share = values[r] / (right + left);
      values[r] = carried + right * share;
      carried = left * share;
    }
    values[p] = carried;
  }
  return result;
}

}  // namespace msbvh::translate
