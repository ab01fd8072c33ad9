#include "core/geometry/curve_set.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/geometry/curve_piece.h"
#include "core/geometry/round_check.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {
namespace {

void check_normals(const CurveSet& curves, const std::string& part) {
  const std::size_t expected = curves.shape == CurveShape::kOriented ? curves.vertices.size() : 0;
  if (curves.normals.size() != expected) {
    throw Error(part + ": normals: found " + std::to_string(curves.normals.size()) + "; expected " +
                std::to_string(expected));
  }
  for (std::size_t i = 0; i < curves.normals.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float x = curves.normals[i][axis];
      if (std::abs(x) <= kMaxCoordinate) continue;  // false for NaN too
      throw Error(part + ": normals: found " + std::to_string(x) + " in element " + std::to_string(i) +
                  "; expected finite numbers of at most 2^60 in size");
    }
  }
}

void check_spans(const CurveSet& curves, const std::string& part) {
  for (std::uint32_t i = 0; i < curves.span_count(); ++i) {
    const std::uint32_t first = curves.spans[i];
    const bool ascends = i == 0 || first >= curves.spans[i - 1] + std::uint64_t(kSpanVertices - 1);
    if (ascends && std::uint64_t(first) + kSpanVertices <= curves.vertex_count) continue;
    throw Error(part + ": spans: span " + std::to_string(i) + " begins at vertex " + std::to_string(first) +
                "; expected one at least 3 behind the span before it, with 4 vertices of " +
                std::to_string(curves.vertex_count));
  }
}

bool closes(const CurveSet& curves, const CurveLoop& loop) {
  const std::uint32_t begin = curves.spans[loop.first], end = curves.spans[loop.last] + kSpanVertices - 1;
  for (std::uint32_t c = 0; c < curves.form().controls(); ++c) {
    const RoundVertex* v = curves.control_vertices(c);
    if (v[begin].p != v[end].p) return false;
  }
  return true;
}

void check_loops(const CurveSet& curves, const std::string& part) {
  for (std::size_t i = 0; i < curves.loops.size(); ++i) {
    const CurveLoop& loop = curves.loops[i];
    bool whole = loop.first <= loop.last && loop.last < curves.span_count() &&
                 !curves.continues(loop.first) &&
                 (loop.last + 1 == curves.span_count() || !curves.continues(loop.last + 1)) &&
                 (i == 0 || curves.loops[i - 1].last < loop.first);
    for (std::uint32_t s = loop.first + 1; whole && s <= loop.last; ++s) whole = curves.continues(s);
    if (whole && closes(curves, loop)) continue;
    throw Error(part + ": loops: loop " + std::to_string(i) + " has spans " + std::to_string(loop.first) +
                " to " + std::to_string(loop.last) +
                "; expected a whole chain of spans that ends where it begins, behind the loop before it");
  }
}

}  // namespace

std::optional<std::uint32_t> CurveSet::neighbour(std::uint32_t span, bool at_end) const {
  if (!at_end && continues(span)) return span - 1;
  if (at_end && span + 1 < span_count() && continues(span + 1)) return span + 1;
  const auto loop = std::ranges::lower_bound(loops, span, {}, at_end ? &CurveLoop::last : &CurveLoop::first);
  if (loop == loops.end() || span != (at_end ? loop->last : loop->first)) return std::nullopt;
  return at_end ? loop->first : loop->last;
}

void validate(const CurveSet& curves) {
  const std::string part = curves.name.empty() ? "curves" : curves.name;
  check_form(curves.form(), part);
  check_vertices(curves.vertices, curves.form(), curves.vertex_count, part);
  check_normals(curves, part);
  check_spans(curves, part);
  check_loops(curves, part);
  if (curves.spans.size() > kMaxSpans) {
    throw Error(part + ": spans: found " + std::to_string(curves.spans.size()) + "; expected at most " +
                std::to_string(kMaxSpans));
  }
}

}  // namespace msbvh
