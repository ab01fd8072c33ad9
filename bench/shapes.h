// Poses that the scene classes are made of.
#pragma once

#include <cstdint>

#include "bench/moved_mesh.h"
#include "bench/procedural.h"

namespace msbvh::bench {

using procedural::Random;

// A closed sphere of about so many triangles with bumps of two sizes, radius 1 -+ `roughness`.
Pose bumpy_sphere(std::uint32_t triangles, float roughness, Random& random);
// The closed surface of the cube [-half, half]^3, subdivided.
Pose cube_shell(std::uint32_t triangles, float half);
// A bar from a to b with a triangle for its section; appended: 6 long thin triangles.
void add_bar(Pose& pose, const Vec3f& a, const Vec3f& b, float thickness);
// Ribbons from a ball's surface outwards, bent, 10 thin triangles each; vertex v belongs to strand v / 12.
Pose strands(std::uint32_t triangles, Random& random);
// Shards (tetrahedra) spread through the cube [-1, 1]^3; vertex v belongs to shard v / 4.
Pose shards(std::uint32_t triangles, Random& random);
// Wheels of 48 spokes and a rim in 96 bars; vertex v belongs to wheel v / kWheelVertices.
inline constexpr std::uint32_t kWheelVertices = (48 + 96) * 6;
struct Wheel {
  Vec3d hub, axis;
};
Pose wheels(std::uint32_t triangles, Random& random, std::vector<Wheel>& placed);

}  // namespace msbvh::bench
