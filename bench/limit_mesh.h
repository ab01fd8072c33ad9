// Subdivision surfaces of the benchmark: a moving cage, and its limit surface as a front-end cuts it.
#pragma once

#include <cstdint>

#include "bench/moved_mesh.h"
#include "bench/procedural.h"
#include "core/geometry/subdivision/subdivision_mesh.h"

namespace msbvh::bench {

// How the edges of a cage are cut.
enum class EdgeRates : std::uint8_t {
  kByLength,  // each into pieces of about one length
  kFinest     // all as the longest one
};

// A closed torus of 24 x 10 faces in cubic bumps, about 2 units across, twisting about its axis.
SubdivisionMesh torus_cage(const TrackForm& form, procedural::Random& random);

// Of about `triangles` by length.
TriangleMesh limit_mesh(const SubdivisionMesh& cage, std::uint32_t triangles,
                        EdgeRates rates = EdgeRates::kByLength);

}  // namespace msbvh::bench
