// One direction of a NURBS patch: its knots, and the B-spline basis over them (Piegl and Tiller, The NURBS
// Book, 1997, chapter 2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

// As UsdGeomNurbsPatch has it.
struct SplineInput {
  std::string name;  // u or v: what its attributes start with
  int vertex_count = 0;
  int order = 0;  // the degree and one
  std::span<const double> knots;
  std::optional<std::array<double, 2>> range;  // of the parameter; none: where all basis functions are
};

// A part of the parameter between two knots that differ.
struct SplineSpan {
  double begin, end;            // inside of the range
  double knot_begin, knot_end;  // of the whole interval
  std::uint32_t first_control;  // `order` of them count, from here on
  std::uint32_t segment;        // among all between neighbouring knots, those without length included
  // How often the knot is there between it and the span before; 0 for the first.
  std::uint32_t repeats = 0;
};

class SplineAxis {
 public:
  static constexpr int kMostOrder = 64;

  // Nothing, with an error, for what makes no spline.
  static std::optional<SplineAxis> make(const SplineInput& input, PrimLog& log);

  std::uint32_t vertex_count() const { return vertex_count_; }
  std::uint32_t order() const { return order_; }
  // Between neighbouring knots: what uniform primvars have values for.
  std::uint32_t segment_count() const { return vertex_count_ - order_ + 1; }
  // Inside of the range; one at least.
  const std::vector<SplineSpan>& spans() const { return spans_; }

  // The `order` basis functions that are not 0 in a span, at a parameter of it, and their derivatives.
  struct Basis {
    std::vector<double> values, derivatives;
  };
  Basis basis(const SplineSpan& span, double parameter) const;

 private:
  SplineAxis(const SplineInput& input, double begin, double end);

  std::uint32_t vertex_count_, order_;
  std::vector<double> knots_;
  std::vector<SplineSpan> spans_;
};

}  // namespace msbvh::translate
