// What the surface area heuristic counts in, and what it knows of a set of references.
#pragma once

#include <bit>
#include <cstddef>

#include "core/build/box4.h"

namespace msbvh {

// Leaves are tested in blocks of so many triangles, hence cost is counted in blocks. A power of two.
inline constexpr unsigned kTrianglesPerBlock = 8;
static_assert(std::has_single_bit(kTrianglesPerBlock));

constexpr float block_count(std::size_t references) {
  return static_cast<float>((references + kTrianglesPerBlock - 1) / kTrianglesPerBlock);
}
inline __m128 block_counts(__m128i references) {
  const __m128i rounded = _mm_add_epi32(references, _mm_set1_epi32(kTrianglesPerBlock - 1));
  return _mm_cvtepi32_ps(_mm_srli_epi32(rounded, std::countr_zero(kTrianglesPerBlock)));
}

// Boxes of a set of references: of the references' own, and of the sums (Box4::sum) of those.
struct SetBounds {
  Box4 box, sums;

  void grow(const Box4& reference) {
    box.grow(reference);
    sums.grow(reference.sum());
  }
  void grow(const SetBounds& other) {
    box.grow(other.box);
    sums.grow(other.sums);
  }
};

}  // namespace msbvh
