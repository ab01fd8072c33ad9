// Cages of subdivision surfaces for tests, about 2 units across, still until moved().
#pragma once

#include <cstdint>

#include "bench/procedural.h"
#include "core/geometry/subdivision/dice.h"
#include "core/geometry/subdivision/subdivision_mesh.h"

namespace msbvh::procedural {

SubdivisionMesh cube_cage();                               // closed, vertices of valence 3
SubdivisionMesh sheet_cage(int side, std::uint64_t seed);  // open, side^2 quads, uneven
SubdivisionMesh prism_cage(int sides);                     // closed: two `sides`-gons and quads; 3: triangles
SubdivisionMesh octahedron_cage();                         // closed, triangles, for Loop as well

SubdivisionMesh moved(SubdivisionMesh centre_pose, const TrackForm& form, const Motion& motion,
                      const Vec3d& offset = {});

// Bumps that depend on the place in space at each key, so that shared points agree.
std::function<double(const SurfacePoint&)> bumps(double amplitude, double wave_length,
                                                 const Vec3d& origin = {});

}  // namespace msbvh::procedural
