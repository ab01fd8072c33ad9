// Normals that are authored for curves, across which ribbons lie then.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/array_samples.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/round/curve_basis.h"
#include "delegate/translate/time_layout.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {

class CurveNormals {
 public:
  // Of `input.normals`, of any interpolation, indexed or not. `frame_only`: the points are carried from the
  // frame, or held: so are their normals. Nothing where none are authored, or, with a warning, where they do
  // not fit the curves or one is NaN.
  static std::optional<CurveNormals> make(const MeshInput& input, const CurveBasis& curves, bool frame_only,
                                          PrimLog& log);

  bool is_still() const { return track_.is_still(); }
  // The fewest even segments of a track of the points whose linear keys follow the normals to
  // kNormalTolerance (normals.h); 0: one key does.
  std::uint32_t segments(const TransformTrack& transform, const TimeLayout& layout,
                         std::uint32_t max_segments) const;
  // [controls][Bezier vertices], at even places of the track.
  std::vector<Vec3f> at_controls(const TransformTrack& transform, const TimeLayout& layout,
                                 std::uint32_t controls, const CurveBasis& curves) const;

 private:
  enum class Interpolation : std::uint8_t { kConstant, kUniform, kVarying, kVertex };

  CurveNormals(Interpolation interpolation, const ArraySamples& samples, std::vector<std::uint32_t> indices)
      : interpolation_(interpolation), track_(samples), indices_(std::move(indices)) {}
  Vec3f of_vertex(const Vec3f* values, std::size_t vertex, const CurveBasis& curves) const;

  Interpolation interpolation_;
  ArrayTrack track_;
  std::vector<std::uint32_t> indices_;  // empty: the values in their order
};

}  // namespace msbvh::translate
