// What may become a leaf.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/build/reference.h"
#include "core/build/sah.h"
#include "core/build/settings.h"

namespace msbvh {

// Below this depth the SAH decides; further down a set is halved, which ends within 32 more levels. Only sets
// that the SAH peels one by one come here.
inline constexpr std::uint32_t kMaxSahDepth = 56;

// A piece of a curve costs about as much as a block of triangles.
inline constexpr std::size_t kMaxLeafPieces = 2;

// One instance, one patch, a few pieces of curves, or so many triangles and points.
template <typename Ref>
bool may_be_leaf(std::span<const Ref> references, const BuildSettings& settings) {
  if (references.size() == 1) return true;
  if (references.size() > settings.max_leaf_triangles) return false;
  const auto alone = [](const Ref& r) { return r.is_instance() || r.is_grid(); };
  const auto curve = [](const Ref& r) { return r.is_curve(); };
  if (std::any_of(references.begin(), references.end(), alone)) return false;
  return references.size() <= kMaxLeafPieces || std::none_of(references.begin(), references.end(), curve);
}

// Not worth a look at its splits: half a block, which costs the same tests as a whole one.
inline bool is_small_leaf(std::size_t references) { return references <= kTrianglesPerBlock / 2; }

}  // namespace msbvh
