// A part of a curve's span by its parameter range: what a tree refers to. The paper's partial primitives
// (Grünschloß et al., HPG 2011, section 3) are parts that a plane cuts off; a curve's are halves, quarters or
// eighths of a span, which bound it as tightly and need no clipping.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/base/box.h"
#include "core/geometry/curve_set.h"

namespace msbvh {

inline constexpr std::uint32_t kMaxPieces = 8;  // of a span; a power of two
inline constexpr std::uint32_t kPieceBits = 4;
inline constexpr std::uint32_t kMaxSpans = 1u << (32 - kPieceBits);

// Part `part` of `parts` equal ones, a power of two.
struct CurvePiece {
  std::uint32_t span = 0, part = 0, parts = 1;

  // In 32 bits: the span, and parts + part - 1.
  constexpr std::uint32_t code() const { return span << kPieceBits | (parts + part - 1); }
  static constexpr CurvePiece of(std::uint32_t code) {
    const std::uint32_t number = (code & ((1u << kPieceBits) - 1u)) + 1, parts = std::bit_floor(number);
    return {code >> kPieceBits, number - parts, parts};
  }
  // Exact.
  constexpr float begin() const { return static_cast<float>(part) / static_cast<float>(parts); }
  constexpr float end() const { return static_cast<float>(part + 1) / static_cast<float>(parts); }
};

// Whether there is anything to hit: a radius above 0 at some control.
bool is_there(const CurveSet& curves, std::uint32_t span);

// Encloses the piece, its width included, while its vertices are as at a control, or as at a time; and padded
// so that interpolated between controls it encloses the piece as a kernel sees it.
Box3f piece_box(const CurveSet& curves, const CurvePiece& piece, std::uint32_t control);
Box3f piece_box_at(const CurveSet& curves, const CurvePiece& piece, float u);
// The same of a span's vertices, for many pieces of it.
using SpanVertices = std::array<RoundVertex, kSpanVertices>;
SpanVertices span_vertices_at(const CurveSet& curves, std::uint32_t span, float u);
Box3f piece_box(const SpanVertices& vertices, const CurvePiece& piece);

}  // namespace msbvh
