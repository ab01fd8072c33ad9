// Curves and points from USD's attributes to the scene's, but for how they move: that is a mesh's business
// (mesh.h), which follows the authored points; what is drawn are mixes of them.
#pragma once

#include <cstdint>
#include <optional>

#include "core/scene/curves.h"
#include "core/scene/points.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/round/curve_basis.h"

namespace msbvh::translate {

class RoundShape {
 public:
  // Of a MeshInput that says that it is curves or points. Nothing, with an error in the log, where it cannot
  // be drawn.
  static std::optional<RoundShape> make(const MeshInput& input, std::size_t points,
                                        std::uint32_t max_segments, PrimLog& log);

  // Of widths that change inside the shutter; 0: they do not.
  std::uint32_t width_segments() const { return widths_.segments; }
  bool is_curves() const { return curves_.has_value(); }

  // On a track of the points; a radius is scaled as its place's transform scales the mean of the axes.
  Curves curves(const MeshInput& input, const MovingArray& points, const Candidate& track,
                std::uint32_t max_segments, PrimLog& optional) const;
  Points points(const MeshInput& input, const MovingArray& points, const Candidate& track,
                std::uint32_t max_segments, PrimLog& optional) const;

 private:
  explicit RoundShape(std::size_t points) : point_count_(points) {}

  std::size_t vertex_count() const { return curves_ ? curves_->vertex_count() : point_count_; }
  std::size_t expected(const std::string& interpolation) const;
  template <typename T>
  Primvar<T> expanded(const PrimvarInput<T>& input, const std::string& attribute, std::uint32_t max_segments,
                      PrimLog& log) const;
  template <typename T>
  void expand(const std::string& interpolation, const std::vector<T>& authored, std::vector<T>& out) const;
  bool read_widths(const MeshInput& input, std::uint32_t max_segments, PrimLog& log);
  void drop_bad_widths(PrimLog& log);
  std::vector<RoundVertex> vertices(const MovingArray& points, const Candidate& track) const;

  std::size_t point_count_;
  std::optional<CurveBasis> curves_;
  Primvar<float> widths_;  // one a vertex
};

}  // namespace msbvh::translate
