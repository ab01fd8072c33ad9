#include "core/build/round_references.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "core/base/parallel.h"
#include "core/geometry/curve_piece.h"

namespace msbvh {
namespace {

constexpr std::size_t kPerTask = 4096;
// Twice as many pieces are worth it where they have at most this share of the area. A long thin span across a
// box's diagonal halves its area with each cut; one along an axis, or as wide as long, gains nothing.
constexpr float kWorthwhile = 0.65f;
// The same in a tree of many spans, where bytes count for more: a million hairs of eight spans at 3 keys take
// 0.36 of the bytes and 0.44 of the build time, and are traced at 0.83 of the rate (docs/design/round.md).
constexpr float kWorthwhileOfMany = 0.55f;
constexpr std::size_t kManySpans = 1u << 20;

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

float worthwhile(const Primitives& primitives) {
  std::size_t spans = 0;
  for (const auto& curves : primitives.curves) spans += curves->spans.size();
  return spans < kManySpans ? kWorthwhile : kWorthwhileOfMany;
}

std::uint32_t pieces_of(const CurveSet& curves, std::uint32_t span, float u, float worthwhile) {
  const SpanVertices vertices = span_vertices_at(curves, span, u);
  std::uint32_t parts = 1;
  for (float area = area_of_pieces(vertices, 1); parts < kMaxPieces; parts *= 2) {
    const float next = area_of_pieces(vertices, 2 * parts);
    if (!(next <= worthwhile * area)) break;
    area = next;
  }
  return parts;
}

// References to a set's primitives, in their order: so many to each as `pieces` says, `make(i, part, parts)`.
template <class Pieces, class Make>
void add(std::size_t count, const Pieces& pieces, const Make& make, std::vector<Reference>& out) {
  std::vector<std::uint8_t> parts(count);
  std::vector<std::size_t> first(1 + (count + kPerTask - 1) / kPerTask, out.size());  // of each range
  parallel_for_ranges(count, kPerTask, [&](std::size_t begin, std::size_t end) {
    std::size_t sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      sum += parts[i] = static_cast<std::uint8_t>(pieces(static_cast<std::uint32_t>(i)));
    first[begin / kPerTask + 1] = sum;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  out.resize(first.back());
  parallel_for_ranges(count, kPerTask, [&](std::size_t begin, std::size_t end) {
    Reference* at = out.data() + first[begin / kPerTask];
    for (std::size_t i = begin; i < end; ++i) {
      for (std::uint32_t part = 0; part < parts[i]; ++part)
        *at++ = make(static_cast<std::uint32_t>(i), part, parts[i]);
    }
  });
}

void add_curves(const Primitives& primitives, std::uint32_t set, std::vector<Reference>& out) {
  const CurveSet& curves = *primitives.curves[set];
  const float centre = primitives.slice.time(0.5f), share = worthwhile(primitives);
  const auto pieces = [&](std::uint32_t span) -> std::uint32_t {
    if (!is_there(curves, span)) return 0;
    return primitives.whole_spans ? 1 : pieces_of(curves, span, centre, share);
  };
  const auto make = [&](std::uint32_t span, std::uint32_t part, std::uint32_t parts) {
    Reference reference{{}, set | Reference::kCurveFlag, CurvePiece{span, part, parts}.code()};
    reference.box = box_at_centre(primitives, reference);
    return reference;
  };
  add(curves.spans.size(), pieces, make, out);
}

void add_points(const Primitives& primitives, std::uint32_t set, std::vector<Reference>& out) {
  const PointSet& points = *primitives.points[set];
  const auto make = [&](std::uint32_t point, std::uint32_t, std::uint32_t) {
    Reference reference{{}, set | Reference::kPointFlag, point};
    reference.box = box_at_centre(primitives, reference);
    return reference;
  };
  add(
      points.point_count, [&](std::uint32_t i) { return is_there(points, i) ? 1u : 0u; }, make, out);
}

}  // namespace

std::vector<Reference> round_references(const Primitives& primitives) {
  std::vector<Reference> all;
  for (std::uint32_t set = 0; set < primitives.curves.size(); ++set) add_curves(primitives, set, all);
  for (std::uint32_t set = 0; set < primitives.points.size(); ++set) add_points(primitives, set, all);
  return all;
}

}  // namespace msbvh
