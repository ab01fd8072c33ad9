#include "delegate/translate/round/nurbs_basis.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "delegate/translate/shape/spline_axis.h"

namespace msbvh::translate {
namespace {

// Spans between two knots of what no cubic is. Their error falls with the fourth power.
constexpr int kPieces = 8;
constexpr std::uint32_t kCubicOrder = 4;

bool check_weights(const CurveTopology& topology, PrimLog& log) {
  const auto bad =
      std::ranges::find_if_not(topology.weights, [](double w) { return std::isfinite(w) && w > 0.0; });
  if (bad == topology.weights.end()) return true;
  return log.reject("pointWeights", message("weight ", bad - topology.weights.begin(), " is ", *bad,
                                            "; expected finite ones above 0"));
}

bool check_size(std::size_t found, std::size_t expected, const char* attribute, const char* as_many_as,
                PrimLog& log) {
  if (found == expected) return true;
  return log.reject(attribute, message("found ", found, " values; expected ", expected, as_many_as));
}

bool check_sizes(const CurveTopology& topology, PrimLog& log) {
  const std::size_t curves = topology.vertex_counts.size();
  if (!check_size(topology.orders.size(), curves, "order", ", one a curve", log)) return false;
  const auto outside = [&](int least, int most) {
    return std::ranges::find_if(topology.orders, [=](int order) { return order < least || order > most; });
  };
  const auto end = topology.orders.end();
  // One beyond what is read leaves out its curve, if the knots say where the next one's begin.
  auto bad = outside(0, std::numeric_limits<int>::max());
  const auto sum = [](std::span<const int> values) {
    return std::accumulate(values.begin(), values.end(), std::size_t(0));
  };
  const std::size_t points = sum(topology.vertex_counts);
  const std::size_t knots = bad == end ? points + sum(topology.orders) : 0;
  if (bad == end && topology.knots.size() != knots) bad = outside(2, SplineAxis::kMostOrder);
  if (bad != end)
    return log.reject("order", message("found ", *bad, "; expected 2 to ", SplineAxis::kMostOrder));
  if (!check_size(topology.knots.size(), knots, "knots", ", vertices and order of each curve", log))
    return false;
  if (!topology.ranges.empty() &&
      !check_size(topology.ranges.size() / 2, curves, "ranges", ", one a curve", log))
    return false;
  return topology.weights.empty() ||
         (check_size(topology.weights.size(), points, "pointWeights", ", one a point", log) &&
          check_weights(topology, log));
}

// A place of a curve and its slope, as mixes of its control points.
struct Place {
  std::vector<double> at, slope;
};

class NurbsCurve {
 public:
  // `weights` are those of the curve's own points; empty: all alike.
  NurbsCurve(std::uint32_t curve, std::uint32_t first, const SplineAxis& axis,
             std::span<const double> weights, CurveBasis& out)
      : curve_(curve), first_(first), axis_(axis), weights_(weights), out_(out) {
    const bool alike = std::ranges::adjacent_find(weights, std::ranges::not_equal_to()) == weights.end();
    if (alike) weights_ = {};
    pieces_ = alike && axis.order() <= kCubicOrder ? 1 : kPieces;
  }

  void add(std::uint32_t first_varying) const {
    for (const SplineSpan& span : axis_.spans()) {
      const bool continues = span.repeats > 0 && span.repeats < axis_.order();
      for (int i = 0; i < pieces_; ++i) add_piece(span, i, continues || i > 0, first_varying);
    }
  }

 private:
  void add_piece(const SplineSpan& span, int piece, bool continues, std::uint32_t first_varying) const {
    const auto parameter = [&](double at) { return std::lerp(span.begin, span.end, (piece + at) / pieces_); };
    const double third = (span.end - span.begin) / (3.0 * pieces_);
    const Place begin = place(span, parameter(0.0)), end = place(span, parameter(1.0));
    out_.add_span(curve_, continues);
    for (std::uint32_t v = continues ? 1 : 0; v < 4; ++v) {
      const Place& near = v < 2 ? begin : end;
      const double along = v == 1 ? third : v == 2 ? -third : 0.0;
      const double share = (parameter(v / 3.0) - span.knot_begin) / (span.knot_end - span.knot_begin);
      const std::uint32_t from = first_varying + span.segment;
      out_.add_vertex(curve_, mix(span, near, along), {from, from + 1, share});
    }
  }
  std::vector<Term> mix(const SplineSpan& span, const Place& place, double along) const {
    std::vector<Term> terms;
    for (std::uint32_t i = 0; i < axis_.order(); ++i) {
      const double weight = place.at[i] + along * place.slope[i];
      if (weight != 0.0) terms.push_back({first_ + span.first_control + i, weight});
    }
    return terms;
  }
  // Rational ones by the quotient rule.
  Place place(const SplineSpan& span, double parameter) const {
    const SplineAxis::Basis basis = axis_.basis(span, parameter);
    Place place{basis.values, basis.derivatives};
    if (weights_.empty()) return place;
    double sum = 0.0, sum_slope = 0.0;
    for (std::uint32_t i = 0; i < axis_.order(); ++i) {
      const double w = weights_[span.first_control + i];
      sum += place.at[i] *= w;
      sum_slope += place.slope[i] *= w;
    }
    for (std::uint32_t i = 0; i < axis_.order(); ++i) {
      place.at[i] /= sum;
      place.slope[i] = (place.slope[i] - place.at[i] * sum_slope) / sum;
    }
    return place;
  }

  const std::uint32_t curve_, first_;
  const SplineAxis& axis_;
  std::span<const double> weights_;
  CurveBasis& out_;
  int pieces_ = 1;
};

std::string attribute_of(const std::string& suffix) {
  return suffix == "Order"   ? "order"
         : suffix == "Range" ? "ranges"
         : suffix == "Knots" ? "knots"
                             : "curveVertexCounts";
}

}  // namespace

bool add_nurbs(const CurveTopology& topology, LeftOut& left_out, CurveBasis& out, PrimLog& log) {
  if (!check_sizes(topology, log)) return false;
  std::size_t first = 0, first_knot = 0, mended = 0;
  Diagnostic first_mended;
  for (std::uint32_t curve = 0; curve < out.curves; ++curve) {
    const int count = topology.vertex_counts[curve], order = topology.orders[curve];
    const std::size_t knots = std::size_t(count) + std::size_t(order);
    SplineInput input{"", count, order, topology.knots.subspan(first_knot, knots), {}};
    if (!topology.ranges.empty()) input.range = {topology.ranges[2 * curve], topology.ranges[2 * curve + 1]};
    std::vector<Diagnostic> said;
    PrimLog own(said, log.path());
    if (const std::optional<SplineAxis> axis = SplineAxis::make(input, own)) {
      if (!said.empty() && mended++ == 0) first_mended = said.front();
      const std::span<const double> weights =
          topology.weights.empty() ? topology.weights : topology.weights.subspan(first, std::size_t(count));
      NurbsCurve(curve, std::uint32_t(first), *axis, weights, out).add(std::uint32_t(out.authored_varying));
      out.authored_varying += axis->segment_count() + 1;
    } else {
      left_out.add(curve, "cannot be read: " + said.front().message, attribute_of(said.front().attribute));
    }
    first += std::size_t(count);
    first_knot += knots;
  }
  if (mended > 0) {
    const std::string others = mended > 1 ? message(" (and ", mended - 1, " more curves)") : "";
    log.warn(attribute_of(first_mended.attribute), first_mended.message + others);
  }
  return true;
}

}  // namespace msbvh::translate
