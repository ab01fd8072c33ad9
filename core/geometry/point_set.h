// Points drawn as spheres: centres and radii that move along tracks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/box.h"
#include "core/geometry/round_vertex.h"
#include "core/motion/bezier.h"
#include "core/motion/track.h"

namespace msbvh {

struct PointSet {
  std::string name;            // in messages: the prim's path
  std::uint32_t segments = 0;  // of the motion; see core/motion/track.h
  std::uint32_t degree = 1;
  std::uint32_t point_count = 0;
  // [form().controls()][point_count], control-major. A radius of 0 at all keys: nothing to hit.
  std::vector<RoundVertex> vertices;

  TrackForm form() const { return {segments, degree}; }
  const RoundVertex* control_vertices(std::uint32_t control) const {
    return vertices.data() + std::size_t(control) * point_count;
  }
  RoundVertex vertex(std::uint32_t point, float u) const {
    if (segments == 0) return vertices[point];
    const SegmentTime at = locate(u, segments);
    const RoundVertex* first = control_vertices(at.key * degree) + point;
    return bezier([&](std::uint32_t i) { return first[std::size_t(i) * point_count]; }, degree, at.w);
  }
};

// The gate: checks the form, the size, that every coordinate is finite and at most kMaxCoordinate
// (core/geometry/triangle_mesh.h) in size, radii at least 0. Throws Error naming the set, the array, what was
// found and what is expected.
void validate(const PointSet& points);

// Whether there is anything to hit: a radius above 0 at some control.
bool is_there(const PointSet& points, std::uint32_t point);

// Encloses the sphere while it is as at a control, or as at a time; and padded so that interpolated between
// controls it encloses the sphere as a kernel sees it.
Box3f point_box(const PointSet& points, std::uint32_t point, std::uint32_t control);
Box3f point_box_at(const PointSet& points, std::uint32_t point, float u);

}  // namespace msbvh
