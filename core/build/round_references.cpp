#include "core/build/round_references.h"

#include <algorithm>
#include <cstddef>

#include "core/base/parallel.h"
#include "core/geometry/curve_piece.h"

namespace msbvh {
namespace {

constexpr std::size_t kPerTask = 4096;
// Twice as many pieces are worth it where they have at most this share of the area. A long thin span across a
// box's diagonal halves its area with each cut; one along an axis, or as wide as long, gains nothing.
constexpr float kWorthwhile = 0.65f;

Box3f box_at_centre(const Primitives& primitives, const Reference& reference) {
  if (!primitives.swept) return round_box_at(primitives, reference, primitives.slice.time(0.5f));
  Box3f box;
  for (std::uint32_t c = 0; c < form_of(primitives, reference).controls(); ++c)
    box.grow(round_box(primitives, reference, c));
  return box;
}

float area_of_pieces(const SpanVertices& vertices, std::uint32_t parts) {
  float area = 0.0f;
  for (std::uint32_t i = 0; i < parts; ++i) area += half_area(piece_box(vertices, {0, i, parts}));
  return area;
}

std::uint32_t pieces_of(const CurveSet& curves, std::uint32_t span, float u) {
  const SpanVertices vertices = span_vertices_at(curves, span, u);
  std::uint32_t parts = 1;
  for (float area = area_of_pieces(vertices, 1); parts < kMaxPieces; parts *= 2) {
    const float next = area_of_pieces(vertices, 2 * parts);
    if (!(next <= kWorthwhile * area)) break;
    area = next;
  }
  return parts;
}

void add_curves(const Primitives& primitives, std::uint32_t set, std::vector<Reference>& out) {
  const CurveSet& curves = *primitives.curves[set];
  const float centre = primitives.slice.time(0.5f);
  std::vector<std::uint8_t> parts(curves.spans.size());
  parallel_for_ranges(parts.size(), kPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto span = static_cast<std::uint32_t>(i);
      if (is_there(curves, span))
        parts[i] = static_cast<std::uint8_t>(primitives.whole_spans ? 1 : pieces_of(curves, span, centre));
    }
  });
  for (std::uint32_t span = 0; span < parts.size(); ++span) {
    for (std::uint32_t i = 0; i < parts[span]; ++i)
      out.push_back({{}, set | Reference::kCurveFlag, CurvePiece{span, i, parts[span]}.code()});
  }
}

void add_points(const Primitives& primitives, std::uint32_t set, std::vector<Reference>& out) {
  const PointSet& points = *primitives.points[set];
  for (std::uint32_t i = 0; i < points.point_count; ++i) {
    if (is_there(points, i)) out.push_back({{}, set | Reference::kPointFlag, i});
  }
}

}  // namespace

std::vector<Reference> round_references(const Primitives& primitives) {
  std::vector<Reference> all;
  for (std::uint32_t set = 0; set < primitives.curves.size(); ++set) add_curves(primitives, set, all);
  for (std::uint32_t set = 0; set < primitives.points.size(); ++set) add_points(primitives, set, all);
  parallel_for_ranges(all.size(), kPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) all[i].box = box_at_centre(primitives, all[i]);
  });
  return all;
}

}  // namespace msbvh
