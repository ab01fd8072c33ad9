#include "core/geometry/curve_piece.h"

#include <algorithm>
#include <cmath>

#include "core/base/lerp.h"

namespace msbvh {
namespace {

// Of the largest coordinate: interpolation of a vertex (kLerpError a degree, there and in the box), and
// rounding of the piece's hull to single precision.
constexpr float kPad = 2.0f * static_cast<float>(kMaxDegree) * kLerpError;

// The control points of the part of a cubic over [a, b] are its blossom at a's and b's: convex combinations
// of the cubic's, so that what holds at the track's controls holds between them.
template <typename Vertex>
Box3f box_of(const CurvePiece& piece, const Vertex& vertex) {
  Vec3d p[kSpanVertices];
  float radius = 0.0f, size = 0.0f;
  for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
    const RoundVertex v = vertex(i);
    p[i] = Vec3d(v.p);
    radius = std::max(radius, v.radius);
    size = std::max({size, std::abs(v.p.x), std::abs(v.p.y), std::abs(v.p.z)});
  }
  Box3f box;
  for (std::uint32_t j = 0; j < kSpanVertices; ++j) {
    const Vec3d c = part_control([&](std::uint32_t i) { return p[i]; }, kSpanVertices - 1,
                                 double(piece.begin()), double(piece.end()), j);
    box.grow(Vec3f(c));
  }
  const float out = radius + kPad * (size + radius);
  const Vec3f pad{out, out, out};
  return {box.lo - pad, box.hi + pad};
}

}  // namespace

bool is_there(const CurveSet& curves, std::uint32_t span) {
  for (std::uint32_t c = 0; c < curves.form().controls(); ++c) {
    const RoundVertex* v = curves.control_vertices(c) + curves.spans[span];
    if (std::any_of(v, v + kSpanVertices, [](const RoundVertex& r) { return r.radius > 0.0f; })) return true;
  }
  return false;
}

Box3f piece_box(const CurveSet& curves, const CurvePiece& piece, std::uint32_t control) {
  const RoundVertex* first = curves.control_vertices(control) + curves.spans[piece.span];
  return box_of(piece, [first](std::uint32_t i) { return first[i]; });
}

Box3f piece_box_at(const CurveSet& curves, const CurvePiece& piece, float u) {
  return piece_box(span_vertices_at(curves, piece.span, u), piece);
}

SpanVertices span_vertices_at(const CurveSet& curves, std::uint32_t span, float u) {
  SpanVertices vertices;
  for (std::uint32_t i = 0; i < kSpanVertices; ++i) vertices[i] = curves.vertex(curves.spans[span] + i, u);
  return vertices;
}

Box3f piece_box(const SpanVertices& vertices, const CurvePiece& piece) {
  return box_of(piece, [&](std::uint32_t i) { return vertices[i]; });
}

}  // namespace msbvh
