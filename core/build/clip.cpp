#include "core/build/clip.h"

#include <cmath>
#include <limits>

namespace msbvh {
namespace {

Vec3d at(const std::array<Vec3d, 3>& triangle, const Vec3d& b) {
  return triangle[0] * b.x + triangle[1] * b.y + triangle[2] * b.z;
}

double largest_coordinate(const std::array<Vec3d, 3>& triangle) {
  const Vec3d m = max(max(abs(triangle[0]), abs(triangle[1])), abs(triangle[2]));
  return std::max({m.x, m.y, m.z});
}

// Keeps the part where sign * (coordinate - plane) <= 0. Should the corners not fit, keeps all: more than the
// fragment is always right.
BarycentricPolygon clip_to_plane(const BarycentricPolygon& in, const std::array<Vec3d, 3>& triangle, int axis,
                                 double plane, double sign) {
  const Vec3d c{triangle[0][axis], triangle[1][axis], triangle[2][axis]};
  const auto outside_by = [&](const Vec3d& b) { return sign * (dot(b, c) - plane * (b.x + b.y + b.z)); };
  BarycentricPolygon out;
  for (int i = 0; i < in.count; ++i) {
    if (out.count + 2 > BarycentricPolygon::kMaxCorners) return in;
    const Vec3d& a = in.corners[i];
    const Vec3d& b = in.corners[i + 1 == in.count ? 0 : i + 1];
    const double da = outside_by(a), db = outside_by(b);
    if (da <= 0.0) out.corners[out.count++] = a;
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
      out.corners[out.count++] = lerp(a, b, da / (da - db));
    }
  }
  return out;
}

}  // namespace

BarycentricPolygon clip_to_box(const std::array<Vec3d, 3>& triangle, const Box3f& box) {
  BarycentricPolygon polygon;
  polygon.corners = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  polygon.count = 3;
  const double error = kClipError * largest_coordinate(triangle);
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clip_to_plane(polygon, triangle, axis, double(box.hi[axis]) + error, 1.0);
    polygon = clip_to_plane(polygon, triangle, axis, double(box.lo[axis]) - error, -1.0);
  }
  return polygon;
}

Box3f clipped_bounds(const std::array<Vec3d, 3>& triangle, Box3f box, int axis, float plane, bool below) {
  (below ? box.hi : box.lo)[axis] = plane;
  const BarycentricPolygon polygon = clip_to_box(triangle, box);
  Box3d bounds;
  for (int i = 0; i < polygon.count; ++i) bounds.grow(at(triangle, polygon.corners[i]));
  return polygon.count == 0 ? Box3f{} : intersect(round_outwards(bounds), box);
}

float round_down(double value) {
  const float f = static_cast<float>(value);
  return double(f) > value ? std::nextafterf(f, -std::numeric_limits<float>::infinity()) : f;
}

float round_up(double value) {
  const float f = static_cast<float>(value);
  return double(f) < value ? std::nextafterf(f, std::numeric_limits<float>::infinity()) : f;
}

Box3f round_outwards(const Box3d& box) {
  return {{round_down(box.lo.x), round_down(box.lo.y), round_down(box.lo.z)},
          {round_up(box.hi.x), round_up(box.hi.y), round_up(box.hi.z)}};
}

}  // namespace msbvh
