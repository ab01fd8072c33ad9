// Points, or normals, that move on their own and under a moving transform: what the stage says at any time,
// the cheapest track that follows it, and the track's controls.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/box.h"
#include "core/base/vec.h"
#include "delegate/translate/array_samples.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {

struct MovingArray {
  ArrayTrack values;
  TransformTrack transform;  // already rebased, so that results fit single precision

  std::size_t size() const { return values.size(); }
  bool is_still() const { return values.is_still() && transform.is_still(); }
  std::vector<Breakpoint> breakpoints() const;
  // Increasing times of the shutter between which the transform does not turn by more than an eighth of a
  // turn.
  std::vector<double> dense_times01() const;
};

// Encloses the points, or the box, at every time of the shutter; not tightly where a transform turns.
Box3d bounds(const MovingArray& points);
Box3d bounds(const Box3d& box, const TransformTrack& transform);

struct PointFit {
  Candidate track{TimeLayout::even(0), 1};  // still: no segments
  double error = 0.0;                       // pixels
};

// Tested at every vertex, so that a vertex far away counts for as little as it shows; the inside of a
// triangle that comes much nearer to the eye than its vertices do may show more.
PointFit fit_points(const MovingArray& points, const ScreenMeasure& measure, const FitSettings& settings);
// [form().controls()][size], control-major, and the guard of TriangleMesh::positions.
std::vector<Vec3f> point_controls(const MovingArray& points, const Candidate& track);

// Normals are kept on linear keys, even in the time of the points' layout. Error as the distance between unit
// vectors: radians, while small.
Fit fit_normals(const MovingArray& normals, const TimeLayout& layout, const FitSettings& settings);
// [key_count(segments)][size], key-major. Unit length, or zero where the stage's normal is.
std::vector<Vec3f> normal_keys(const MovingArray& normals, const TimeLayout& layout, std::uint32_t segments);

}  // namespace msbvh::translate
