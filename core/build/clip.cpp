#include "core/build/clip.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace msbvh {
namespace {

Vec3d at(const std::array<Vec3d, 3>& triangle, const Vec3d& b) {
  return triangle[0] * b.x + triangle[1] * b.y + triangle[2] * b.z;
}

// std::nextafter() towards infinity, of what is neither infinity nor NaN, without a call of the C library:
// boxes are rounded outwards several times a node.
float next_above(float f) {
  const auto bits = std::bit_cast<std::uint32_t>(f);
  return std::bit_cast<float>(f > 0.0f ? bits + 1 : f < 0.0f ? bits - 1 : 1u);
}

double largest_coordinate(const std::array<Vec3d, 3>& triangle) {
  const Vec3d m = max(max(abs(triangle[0]), abs(triangle[1])), abs(triangle[2]));
  return std::max({m.x, m.y, m.z});
}

// Clips one polygon after the other between two buffers: filling a third with zeros costs more than clipping.
class Clipper {
 public:
  explicit Clipper(const std::array<Vec3d, 3>& triangle) : triangle_(triangle) {
    polygons_[0].corners[0] = {1, 0, 0};
    polygons_[0].corners[1] = {0, 1, 0};
    polygons_[0].corners[2] = {0, 0, 1};
    polygons_[0].count = 3;
  }
  const BarycentricPolygon& polygon() const { return polygons_[current_]; }

  // Keeps the part where sign * (coordinate - plane) <= 0. Should the corners not fit, keeps all: more than
  // the fragment is always right.
  void clip(int axis, double plane, double sign) {
    const Vec3d c{triangle_[0][axis], triangle_[1][axis], triangle_[2][axis]};
    if (sign * (c.x - plane) <= 0.0 && sign * (c.y - plane) <= 0.0 && sign * (c.z - plane) <= 0.0) return;
    const BarycentricPolygon& in = polygons_[current_];
    BarycentricPolygon& out = polygons_[1 - current_];
    out.count = 0;
    double outside_by[BarycentricPolygon::kMaxCorners];
    for (int i = 0; i < in.count; ++i) {
      const Vec3d& b = in.corners[i];
      outside_by[i] = sign * (dot(b, c) - plane * (b.x + b.y + b.z));
    }
    for (int i = 0; i < in.count; ++i) {
      if (out.count + 2 > BarycentricPolygon::kMaxCorners) return;
      const int next = i + 1 == in.count ? 0 : i + 1;
      const double da = outside_by[i], db = outside_by[next];
      if (da <= 0.0) out.corners[out.count++] = in.corners[i];
      if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
        out.corners[out.count++] = lerp(in.corners[i], in.corners[next], da / (da - db));
      }
    }
    current_ = 1 - current_;
  }

  void clip(const Box3f& box, double error) {
    for (int axis = 0; axis < 3; ++axis) {
      clip(axis, double(box.hi[axis]) + error, 1.0);
      clip(axis, double(box.lo[axis]) - error, -1.0);
    }
  }

  Box3f bounds() const {
    Box3d bounds;
    for (int i = 0; i < polygon().count; ++i) bounds.grow(at(triangle_, polygon().corners[i]));
    return polygon().count == 0 ? Box3f{} : round_outwards(bounds);
  }

 private:
  const std::array<Vec3d, 3>& triangle_;
  BarycentricPolygon polygons_[2];
  int current_ = 0;
};

}  // namespace

BarycentricPolygon clip_to_box(const std::array<Vec3d, 3>& triangle, const Box3f& box) {
  Clipper clipper(triangle);
  clipper.clip(box, kClipError * largest_coordinate(triangle));
  return clipper.polygon();
}

CutBounds cut_bounds(const std::array<Vec3d, 3>& triangle, const Box3f& box, int axis, float plane) {
  const double error = kClipError * largest_coordinate(triangle);
  Clipper below(triangle);
  below.clip(box, error);
  Clipper above = below;
  below.clip(axis, double(plane) + error, 1.0);
  above.clip(axis, double(plane) - error, -1.0);
  Box3f low = box, high = box;
  low.hi[axis] = plane;
  high.lo[axis] = plane;
  return {intersect(below.bounds(), low), intersect(above.bounds(), high)};
}

float round_down(double value) {
  const float f = static_cast<float>(value);
  return double(f) > value ? -next_above(-f) : f;
}

float round_up(double value) {
  const float f = static_cast<float>(value);
  return double(f) < value ? next_above(f) : f;
}

Box3f round_outwards(const Box3d& box) {
  return {{round_down(box.lo.x), round_down(box.lo.y), round_down(box.lo.z)},
          {round_up(box.hi.x), round_up(box.hi.y), round_up(box.hi.z)}};
}

}  // namespace msbvh
