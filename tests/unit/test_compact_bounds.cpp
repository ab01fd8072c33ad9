// Boxes in 16 bits a plane: never smaller than what they stand for, and by less than two of their units, or
// of the last places of a float, larger.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <doctest/doctest.h>
#include <limits>
#include <random>
#include <vector>

#include "core/bvh/compact_bounds.h"

using namespace msbvh;

namespace {

std::vector<Box3f> random_boxes(std::mt19937_64& random, float offset, float size) {
  std::uniform_real_distribution<float> at(0.0f, size);
  std::vector<Box3f> boxes(1 + random() % 16);
  for (Box3f& box : boxes) {
    for (int i = 0; i < 2; ++i) box.grow(Vec3f{offset + at(random), -offset + at(random), at(random)});
  }
  return boxes;
}

float next_above(float x) { return std::nextafter(x, std::numeric_limits<float>::infinity()); }

// How far a plane may move: two units, or so many floats.
double allowed(const NodeFrame& frame, int axis, float x) {
  const float size = std::max(std::abs(x), std::abs(frame.origin[axis]));
  return 2.0 * double(frame.scale(axis)) + 2.0 * (double(next_above(size)) - double(size));
}

void check_rounded(const std::vector<Box3f>& exact) {
  const NodeFrame frame = frame_around(exact);
  std::vector<Box3f> rounded = exact;
  round_outwards(rounded);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    CHECK(rounded[i].contains(exact[i]));
    for (int a = 0; a < 3; ++a) {
      CHECK(double(exact[i].lo[a]) - double(rounded[i].lo[a]) <= allowed(frame, a, exact[i].lo[a]));
      CHECK(double(rounded[i].hi[a]) - double(exact[i].hi[a]) <= allowed(frame, a, exact[i].hi[a]));
    }
  }
  // What has been rounded stays: a node writes the very boxes that its parent was made of.
  const NodeFrame again = frame_around(rounded);
  CompactBounds bounds{};
  for (int a = 0; a < 3; ++a) {
    CHECK(again.origin[a] == frame.origin[a]);
    CHECK(again.exponent[a] == frame.exponent[a]);
  }
  for (const Box3f& box : rounded) {
    bounds.set_box(again, 3, box);
    const Box3f written = bounds.box(again, 3);
    CHECK(written.lo == box.lo);
    CHECK(written.hi == box.hi);
  }
}

}  // namespace

TEST_CASE("boxes in 16 bits enclose what they stand for, tightly, at every size and place") {
  std::mt19937_64 random(7);
  for (const float offset : {0.0f, 1.0f, -3.0f, 1e4f, 1e7f, -1e30f}) {
    for (const float size : {0.0f, 1e-42f, 1e-38f, 1e-6f, 1.0f, 300.0f, 1e12f, 1e36f}) {
      CAPTURE(offset);
      CAPTURE(size);
      for (int i = 0; i < 50; ++i) check_rounded(random_boxes(random, offset, size));
    }
  }
}

TEST_CASE("boxes whose sides are a few floats apart") {
  std::mt19937_64 random(11);
  for (const float at : {1.0f, 16777216.0f, 1e-30f, -5.0f}) {
    for (int i = 0; i < 500; ++i) {
      std::vector<Box3f> boxes(4);
      for (Box3f& box : boxes) {
        Vec3f p{at, at, at};
        for (int a = 0; a < 3; ++a) {
          for (std::uint64_t steps = random() % 9; steps > 0; --steps) p[a] = next_above(p[a]);
        }
        box.grow(p);
        box.grow(Vec3f{next_above(p.x), p.y, next_above(next_above(p.z))});
      }
      check_rounded(boxes);
    }
  }
}

// The decoded plane is exactly origin + q * 2^exponent, rounded once: doubles hold the product, and the sum
// where the two are near; elsewhere the judge is that fused and unfused agree.
TEST_CASE("fused and unfused decoding find the same plane") {
  std::mt19937_64 random(13);
  for (int i = 0; i < 100000; ++i) {
    NodeFrame frame{};
    frame.origin[0] = std::ldexp(float(std::int32_t(random())), int(random() % 60) - 60);
    frame.exponent[0] = static_cast<std::uint8_t>(1 + random() % 200);
    const auto q = static_cast<std::uint16_t>(random());
    CHECK(frame.plane(0, q) == std::fma(static_cast<float>(q), frame.scale(0), frame.origin[0]));
  }
}
