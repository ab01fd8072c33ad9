// Curves of every basis as chains of cubic Bezier spans, without loss: each Bezier vertex is a fixed mix of
// authored ones, so that whatever is authored a vertex (points, widths, colours) is converted alike, at every
// time. UsdGeomBasisCurves' documentation says which curves there are and what they are made of; G. Farin,
// Curves and Surfaces for CAGD, 5th ed., chapters 8 and 9, has the conversions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/curve_set.h"
#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

// UsdGeomBasisCurves' tokens, and those of two other kinds of curves.
struct CurveTopology {
  // linear, cubic; hermite: the points are those of the curves, then as many tips of their tangents (point +
  // tangent); nurbs
  std::string type = "cubic";
  std::string basis = "bezier";      // of cubic ones: bezier, bspline, catmullRom
  std::string wrap = "nonperiodic";  // of linear and cubic ones: nonperiodic, periodic, pinned
  std::span<const int> vertex_counts;
  // Of nurbs, as UsdGeomNurbsCurves has them: one order a curve, the knots of all curves, the first and the
  // last parameter of each or none, one weight a point or none.
  std::span<const int> orders{};
  std::span<const double> knots{}, ranges{}, weights{};
  // Of linear and cubic ones, as Hydra's curves may have them: the point of each vertex, and curves that are
  // not drawn. None: vertices are points, in their order, and all are drawn.
  std::span<const int> indices{}, hidden{};
};

// A share of an authored value.
struct Term {
  std::uint32_t index;
  double weight;
};

// Bezier vertices as mixes of what is authored.
struct CurveBasis {
  std::vector<std::uint32_t> first_term;  // of each Bezier vertex in `terms`, and the end
  std::vector<Term> terms;                // of authored vertices
  // Of `varying` values, one a span's end: which two each Bezier vertex lies between, and how far.
  struct Between {
    std::uint32_t from, to;
    double w;
  };
  std::vector<Between> varying;
  std::vector<std::uint32_t> spans;        // the first Bezier vertex of each; see core/geometry/curve_set.h
  std::vector<CurveLoop> loops;            // of periodic curves
  std::vector<std::uint32_t> span_curves;  // the authored curve of each span
  std::vector<std::uint32_t> vertex_curves;
  std::size_t curves = 0, authored_vertices = 0, authored_varying = 0;
  // Values of interpolation `vertex` are blended as those of `varying`: the curve does not blend its
  // vertices.
  bool vertex_as_varying = false;

  // A span of a curve, which carries on the one before it or not; its vertices come next, without the shared
  // one.
  void add_span(std::uint32_t curve, bool continues);
  void add_vertex(std::uint32_t curve, std::span<const Term> mix, const Between& between);
  std::size_t vertex_count() const { return vertex_curves.size(); }
  std::span<const Term> terms_of(std::size_t vertex) const {
    return {terms.data() + first_term[vertex], first_term[vertex + 1] - first_term[vertex]};
  }
};

// Nothing, with an error in the log, for tokens that there are not, counts that are negative, counts that do
// not add up to `points` or to the indices, and indices of no point. Curves of too few vertices, or of a
// number that their basis does not have, are left out with one warning; their values are skipped.
std::optional<CurveBasis> curve_basis(const CurveTopology& topology, std::size_t points, PrimLog& log);

}  // namespace msbvh::translate
