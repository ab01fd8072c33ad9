// Rays that none of a closed mesh may let out: each starts at a point that the mesh surrounds, or goes
// through it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/probe/probe_random.h"
#include "core/probe/shown.h"
#include "core/trace/ray.h"

namespace msbvh {

enum class InsideAim : std::uint8_t {
  kAnywhere,     // in any direction
  kEdges,        // at a point of a triangle's edge
  kVertices,     // at a vertex
  kAlongFaces,   // in a direction that lies in a triangle
  kFromSurface,  // from a point of a triangle, through the point inside
  kInPlanes      // in a plane of two axes in which a box ends; half of them along one
};
inline constexpr InsideAim kInsideAims[] = {InsideAim::kAnywhere,    InsideAim::kEdges,
                                            InsideAim::kVertices,    InsideAim::kAlongFaces,
                                            InsideAim::kFromSurface, InsideAim::kInPlanes};
const char* inside_aim_name(InsideAim aim);  // "in any direction", "at edges", ...

enum class InsideMix : std::uint8_t {
  kHard,  // all aims in turn, half of the times at keys and next to them
  kPlain  // in any direction, at any time
};

struct InsideRays {
  std::vector<Ray> rays;
  std::vector<InsideAim> aims;
  std::vector<const ShownMesh*> from;
};

// Appends `count` rays that meet in a point inside of the mesh at a random time; none where the mesh is not
// there then, or no point inside is found. The point is farther from the surface than what a kernel rounds,
// so that a ray without a hit is a leak.
void add_inside_rays(const ShownMeshes& all, const ShownMesh& shown, std::size_t count, InsideMix mix,
                     ProbeRandom& random, InsideRays& out);

// About `count` rays from `starts` points and times in each of the meshes. The same for a seed.
InsideRays inside_rays(const ShownMeshes& all, const std::vector<const ShownMesh*>& closed,
                       std::size_t starts, std::size_t count, std::uint64_t seed,
                       InsideMix mix = InsideMix::kHard);

}  // namespace msbvh
