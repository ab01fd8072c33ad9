// Rays aimed where a tree is likeliest to lose one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bvh/bvh.h"
#include "core/trace/ray.h"

namespace msbvh {

enum class Aim : std::uint8_t {
  kAnywhere,     // between two points of the scene's box
  kEdges,        // at a point of a triangle's edge
  kVertices,     // at a vertex
  kAlongFaces,   // at a point of a triangle, in its plane
  kFromSurfaces  // from a point of a triangle, in any direction
};
inline constexpr Aim kAims[] = {Aim::kAnywhere, Aim::kEdges, Aim::kVertices, Aim::kAlongFaces,
                                Aim::kFromSurfaces};
const char* aim_name(Aim aim);  // "anywhere", "at edges", ...

// `count` rays, or none where the aim finds nothing to aim at: no triangles, or an empty tree. Times are
// random, half of them at keys and next to them. A fourth of the rays ends at random.
std::vector<Ray> aimed_rays(const Bvh& world, Aim aim, std::size_t count, std::uint64_t seed);

}  // namespace msbvh
