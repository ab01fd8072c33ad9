// Seeded procedural meshes and rays for tests and benchmarks. Every generator takes the number of segments
// (0: still) and makes the same shape at the shutter's centre for any of them.
#pragma once

#include <cstdint>
#include <functional>

#include "core/geometry/triangle_mesh.h"
#include "core/trace/ray.h"

namespace msbvh::procedural {

// A small deterministic generator: 32-bit PCG (M. O'Neill, 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 6364136223846793005ull + 1442695040888963407ull) {
    next();
  }
  std::uint32_t next();
  float uniform() { return static_cast<float>(next() >> 8) * 0x1p-24f; }  // [0, 1)
  float uniform(float lo, float hi) { return lo + (hi - lo) * uniform(); }
  Vec3f in_box(const Vec3f& lo, const Vec3f& hi);
  Vec3f direction();  // on the unit sphere

 private:
  std::uint64_t state_;
};

// Moves a point of the centre pose to time u in [0, 1].
using Motion = std::function<Vec3d(const Vec3d& centre, double u)>;
Motion translation(const Vec3d& over_shutter);
Motion rotation(const Vec3d& axis, double radians_over_shutter, const Vec3d& pivot = {});
Motion wave(double amplitude, double wave_length);

// Samples `motion` so that the track passes through it: at the keys and, for curves, at places between.
// `offset` is added to every position in double, before rounding.
TriangleMesh moved(TriangleMesh centre_pose, const TrackForm& form, const Motion& motion,
                   const Vec3d& offset = {});
TriangleMesh moved(TriangleMesh centre_pose, std::uint32_t segments, const Motion& motion,
                   const Vec3d& offset = {});

// All of them about 1 to 10 units across, around the origin.
TriangleMesh sphere(int rings);                      // closed, 2 * rings * (2 * rings - 2) triangles
TriangleMesh grid(int side);                         // in the xz plane, 2 * side^2 triangles
TriangleMesh sticks(int count, std::uint64_t seed);  // long thin closed tubes, 6 triangles each
TriangleMesh soup(int count, float size, std::uint64_t seed);  // free triangles
TriangleMesh debris(int count, std::uint32_t segments, float speed,
                    std::uint64_t seed);    // each its own velocity
TriangleMesh wheel(int spokes, int rings);  // rim and spokes in the xy plane

// From around to inside the box, at random times.
Ray random_ray(Random& random, const Vec3f& centre, float radius);

}  // namespace msbvh::procedural
