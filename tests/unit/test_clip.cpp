// Fragments: what is cut by a plane is lost on neither side.
#include <algorithm>
#include <array>
#include <doctest/doctest.h>

#include "bench/procedural.h"
#include "core/build/clip.h"

using namespace msbvh;
using procedural::Random;

namespace {

// The largest of sign times a coordinate over the polygon, to more digits than it was clipped with.
long double farthest(const BarycentricPolygon& polygon, const std::array<Vec3d, 3>& triangle, int axis,
                     long double sign) {
  long double most = -1e30L;
  for (int i = 0; i < polygon.count; ++i) {
    long double sum = 0.0L;
    for (int k = 0; k < 3; ++k)
      sum += static_cast<long double>(polygon.corners[std::size_t(i)][k]) *
             static_cast<long double>(triangle[std::size_t(k)][axis]);
    most = std::max(most, sign * sum);
  }
  return most;
}

}  // namespace

TEST_CASE("fragments on both sides of a plane reach it, or beyond") {
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const float size = i % 2 == 0 ? 1.0f : 1e6f;
    std::array<Vec3d, 3> triangle;
    Box3f box;
    for (Vec3d& corner : triangle) {
      const Vec3f p = random.in_box({-size, -size, -size}, {size, size, size});
      corner = Vec3d(p);
      box.grow(p);
    }
    const int axis = i % 3;
    const float plane = random.uniform(box.lo[axis], box.hi[axis]);
    Box3f below = box, above = box;
    below.hi[axis] = plane;
    above.lo[axis] = plane;
    const BarycentricPolygon low = clip_to_box(triangle, below), high = clip_to_box(triangle, above);
    REQUIRE(low.count >= 3);
    REQUIRE(high.count >= 3);
    CHECK(farthest(low, triangle, axis, 1.0L) >= static_cast<long double>(plane));
    CHECK(farthest(high, triangle, axis, -1.0L) >= -static_cast<long double>(plane));
  }
}
