// Poses that the scene classes are made of.
#pragma once

#include <cstdint>

#include "bench/moved_mesh.h"
#include "bench/procedural.h"
#include "core/geometry/curve_set.h"
#include "core/geometry/point_set.h"

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

// About a unit axis.
Vec3d turned(const Vec3d& v, const Vec3d& axis, double radians);

// Strands of `spans` cubic spans each from a ball of radius 0.6 outwards, bent, `width` wide at the root and
// a fifth of it at the tip. Each sways about its root while the shutter is open.
CurveSet hairs(std::uint32_t count, std::uint32_t spans, float width, const TrackForm& form, Random& random);
// Blades of two spans on a square of 2 x 2, leaning with a wind that runs over it.
CurveSet blades(std::uint32_t count, const TrackForm& form, Random& random);
// Balls in the cube [-1, 1]^3 with velocities of their own, about as wide as they lie apart.
PointSet balls(std::uint32_t count, const TrackForm& form, Random& random);

}  // namespace msbvh::bench
