// Curves: chains of cubic Bezier spans whose control vertices, radii among them, move along tracks. Linear
// curves and other bases are converted without loss by the front-end (delegate/translate/curve_basis.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/round_vertex.h"
#include "core/motion/bezier.h"
#include "core/motion/track.h"

namespace msbvh {

// What is drawn around the centre line.
enum class CurveShape : std::uint8_t {
  kRibbon,    // flat, 2 radii wide, turned to each ray
  kOriented,  // flat, across the curve's own normals: a surface that does not depend on the ray
  kTube       // round: the union of the balls around the centre line
};

// Vertices of a span.
inline constexpr std::uint32_t kSpanVertices = 4;

// The spans of a curve whose end is its beginning, both included.
struct CurveLoop {
  std::uint32_t first, last;
  bool operator==(const CurveLoop&) const = default;
};

struct CurveSet {
  std::string name;            // in messages: the prim's path
  std::uint32_t segments = 0;  // of the motion; see core/motion/track.h
  std::uint32_t degree = 1;
  CurveShape shape = CurveShape::kRibbon;
  std::uint32_t vertex_count = 0;
  // [form().controls()][vertex_count], control-major. A span's control vertices lie next to each other.
  std::vector<RoundVertex> vertices;
  // kOriented: across which the ribbon lies, as many and in the same order; need not be unit length. Else
  // empty.
  std::vector<Vec3f> normals;
  // The first of each span's four vertices, ascending. Spans of one curve that follow each other share the
  // vertex between them: the next one's first is 3 behind.
  std::vector<std::uint32_t> spans;
  // Of periodic curves, ascending; the others' ends are free. Where one's last vertex lies, its first one
  // does.
  std::vector<CurveLoop> loops;

  TrackForm form() const { return {segments, degree}; }
  std::uint32_t span_count() const { return static_cast<std::uint32_t>(spans.size()); }
  const RoundVertex* control_vertices(std::uint32_t control) const {
    return vertices.data() + std::size_t(control) * vertex_count;
  }
  const Vec3f* control_normals(std::uint32_t control) const {
    return normals.data() + std::size_t(control) * vertex_count;
  }
  RoundVertex vertex(std::uint32_t vertex, float u) const {
    if (segments == 0) return vertices[vertex];
    const SegmentTime at = locate(u, segments);
    const RoundVertex* first = control_vertices(at.key * degree) + vertex;
    return bezier([&](std::uint32_t i) { return first[std::size_t(i) * vertex_count]; }, degree, at.w);
  }
  // kOriented alone.
  Vec3f normal(std::uint32_t vertex, float u) const {
    if (segments == 0) return normals[vertex];
    const SegmentTime at = locate(u, segments);
    const Vec3f* first = control_normals(at.key * degree) + vertex;
    return bezier([&](std::uint32_t i) { return first[std::size_t(i) * vertex_count]; }, degree, at.w);
  }
  // Whether a span carries on where the one before it ends.
  bool continues(std::uint32_t span) const {
    return span > 0 && spans[span] == spans[span - 1] + kSpanVertices - 1;
  }
  // The span that carries on at a span's end, or that it carries on; none: its end is free.
  std::optional<std::uint32_t> neighbour(std::uint32_t span, bool at_end) const;
};

// The gate: checks the form, the sizes, that spans lie inside the vertices, that loops are chains that close,
// that every coordinate is finite and at most kMaxCoordinate (core/geometry/triangle_mesh.h) in size, radii
// at least 0. Throws Error naming the set, the array, what was found and what is expected.
void validate(const CurveSet& curves);

}  // namespace msbvh
