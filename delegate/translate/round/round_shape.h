// Curves and points from USD's attributes to the scene's, but for how they move: that is a mesh's business
// (mesh.h), which follows the authored points; what is drawn are mixes of them.
#pragma once

#include <cstdint>
#include <optional>

#include "core/scene/curves.h"
#include "core/scene/points.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/material_table.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/round/curve_basis.h"
#include "delegate/translate/round/curve_normals.h"
#include "delegate/translate/screen_measure.h"

namespace msbvh::translate {

class RoundShape {
 public:
  // Of a MeshInput that says that it is curves or points. `frame_only` as of PointMotion. Nothing, with an
  // error in the log, where it cannot be drawn.
  static std::optional<RoundShape> make(const MeshInput& input, std::size_t points, bool frame_only,
                                        CurveStyle style, std::uint32_t max_segments, PrimLog& log);

  // Whether widths and normals are the same throughout the shutter, in the shape's own space.
  bool is_still() const { return widths_.segments == 0 && (!normals_ || normals_->is_still()); }
  // Half of the largest width, in the shape's own space: how far it reaches beyond its points.
  double reach() const;
  // How many even segments widths and normals need of a linear track of the points; 0: they ask for none.
  // `box` holds the points in the space that they are seen in.
  std::uint32_t needed_segments(const TransformTrack& transform, const TimeLayout& layout,
                                const ScreenMeasure& measure, const Box3d& box,
                                const FitSettings& settings) const;
  bool is_curves() const { return curves_.has_value(); }

  // On a track of the points; a radius is scaled as its place's transform scales the mean of the axes.
  Curves curves(const MeshInput& input, const MovingArray& points, const Candidate& track,
                const MaterialTable& materials, std::uint32_t max_segments, PrimLog& optional) const;
  Points points(const MeshInput& input, const MovingArray& points, const Candidate& track,
                const MaterialTable& materials, std::uint32_t max_segments, PrimLog& optional) const;

 private:
  explicit RoundShape(std::size_t points) : point_count_(points) {}

  std::size_t vertex_count() const { return curves_ ? curves_->vertex_count() : point_count_; }
  std::size_t expected(const std::string& interpolation) const;
  template <typename T>
  Primvar<T> expanded(const PrimvarInput<T>& input, const std::string& attribute, std::uint32_t max_segments,
                      PrimLog& log) const;
  template <typename T>
  void expand(const std::string& interpolation, const std::vector<T>& authored, std::vector<T>& out) const;
  void add_primvars(const MeshInput& input, const MaterialTable& materials, std::uint32_t max_segments,
                    Appearance& look, PrimLog& optional) const;
  std::uint32_t scale_segments(const TransformTrack& transform, const ScreenMeasure& measure,
                               const Box3d& box, const FitSettings& settings) const;
  bool read_widths(const MeshInput& input, std::uint32_t max_segments, PrimLog& log);
  void drop_bad_widths(PrimLog& log);
  std::vector<RoundVertex> vertices(const MovingArray& points, const Candidate& track) const;

  std::size_t point_count_;
  std::optional<CurveBasis> curves_;
  CurveShape style_ = CurveShape::kRibbon;
  std::optional<CurveNormals> normals_;  // of kOriented
  Primvar<float> widths_;                // one a vertex
};

}  // namespace msbvh::translate
