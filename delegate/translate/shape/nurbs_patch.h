// A NURBS patch: where its surface is, and into how many cells it is cut. Trim curves are not honoured.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/sample/pixel_size.h"
#include "delegate/translate/shape/spline_axis.h"

namespace msbvh::translate {

// As a front-end has looked it up, at the frame. Whether it is open, closed or periodic is for those who edit
// it: points and knots alone say where the surface is (UsdGeomNurbsPatch).
struct NurbsInput {
  std::string path;  // of the prim, for messages
  SplineInput u, v;
};

// Into how many cells each span is cut.
struct NurbsCells {
  std::vector<std::uint32_t> u, v;
};

class NurbsPatch {
 public:
  // No span is cut into more cells, and no patch into more than kMostCells.
  static constexpr std::uint32_t kMostSpanCells = 2048;
  static constexpr std::uint64_t kMostCells = std::uint64_t(1) << 22;

  // Nothing, with an error, for what makes no surface.
  static std::optional<NurbsPatch> make(const NurbsInput& input, PrimLog& log);

  const SplineAxis& u() const { return u_; }
  const SplineAxis& v() const { return v_; }
  // Control points lie row by row, from one to the next along u.
  std::size_t control_count() const { return std::size_t(u_.vertex_count()) * v_.vertex_count(); }

  // One positive weight a control point, or none.
  bool check_weights(std::span<const double> weights, PrimLog& log) const;
  // Whether so many values fit a primvar of that interpolation, and the indices (none: not indexed) the
  // values.
  bool check_primvar(const std::string& interpolation, std::size_t value_count, std::span<const int> indices,
                     const std::string& attribute, PrimLog& log) const;

  // Cells with edges of about so many pixels where they are seen largest, of any of the poses (each of
  // control_count() points) under any of the matrices, to the space that pixels are measured in.
  // `edge_pixels` 0: as many cells a span as its degree. Fewer, with a warning, where there would be too
  // many.
  NurbsCells cells(std::span<const std::span<const Vec3f>> poses, std::span<const double> weights,
                   std::span<const Matrix4d> matrices, const PixelSize& pixel_size, double edge_pixels,
                   PrimLog& log) const;

 private:
  NurbsPatch(SplineAxis u, SplineAxis v) : u_(std::move(u)), v_(std::move(v)) {}

  SplineAxis u_, v_;
};

// Basis functions at parameters of an axis, to evaluate many values with.
struct SplineStencil {
  std::uint32_t first_control;
  std::vector<double> weights;
};

// What a patch has at the crossings of parameters along u and v, before it is divided by the weight, which
// comes last: [v][u][width + 1]. `values`: of the control points, weighted by `weights` (none: all 1).
std::vector<double> weighted_crossings(const NurbsPatch& patch, std::span<const SplineStencil> u,
                                       std::span<const SplineStencil> v, std::span<const float> values,
                                       std::size_t width, std::span<const double> weights);
// The same, divided: [v][u][width].
std::vector<double> crossings(const NurbsPatch& patch, std::span<const SplineStencil> u,
                              std::span<const SplineStencil> v, std::span<const float> values,
                              std::size_t width, std::span<const double> weights);

}  // namespace msbvh::translate
