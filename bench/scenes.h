// Seeded procedural scenes for the benchmarks. The same seed makes the same scene on any machine.
#pragma once

#include <cstdint>

#include "core/geometry/triangle_mesh.h"

namespace msbvh::bench {

// Small triangles, evenly spread in the unit cube; each turns and travels on its own.
TriangleMesh make_soup(std::uint32_t triangles, std::uint32_t segments, std::uint32_t seed);

// Strands of long thin triangles that swing about their roots: the paper's kind of scene, where boxes fit
// badly.
TriangleMesh make_hair(std::uint32_t triangles, std::uint32_t segments, std::uint32_t seed);

// A closed, wrinkled sphere that rolls; neighbours move alike.
TriangleMesh make_sphere(std::uint32_t triangles, std::uint32_t segments, std::uint32_t seed);

struct SceneKind {
  const char* name;
  TriangleMesh (*make)(std::uint32_t triangles, std::uint32_t segments, std::uint32_t seed);
};

inline constexpr SceneKind kScenes[] = {{"soup", make_soup}, {"hair", make_hair}, {"sphere", make_sphere}};

}  // namespace msbvh::bench
