#include "delegate/translate/shape/surface.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace msbvh::translate {
namespace {

constexpr double kPi = std::numbers::pi;

// Of a profile: a circle around z.
struct Ring {
  double radius, z;
};

// Turns profiles around z. The parts of a surface share no vertices.
class Lathe {
 public:
  explicit Lathe(int sides) {
    const double step = 2.0 * kPi / sides;
    for (int i = 0; i < sides; ++i) circle_.push_back({std::cos(i * step), std::sin(i * step), 0.0});
  }

  // From the lower to the upper end; quads between its rings.
  void turn(std::span<const Ring> profile) {
    const int sides = int(circle_.size());
    int low = int(surface_.points.size());
    for (const Ring& ring : profile) {
      for (const Vec3d& p : circle_)
        surface_.points.push_back({p.x * ring.radius, p.y * ring.radius, ring.z});
    }
    for (std::size_t row = 1; row < profile.size(); ++row, low += sides) {
      for (int here = 0; here < sides; ++here) {
        const int there = (here + 1) % sides;
        surface_.counts.push_back(4);
        for (const int index : {low + here, low + there, low + sides + there, low + sides + here}) {
          surface_.indices.push_back(index);
        }
      }
    }
  }
  Surface finished() { return std::move(surface_); }

 private:
  std::vector<Vec3d> circle_;  // of radius 1
  Surface surface_;
};

std::vector<double> even_angles(double from, double to, int intervals) {
  const double step = (to - from) / intervals;
  std::vector<double> angles;
  for (int i = 0; i < intervals; ++i) angles.push_back(i * step + from);
  angles.push_back(to);
  return angles;
}

Surface sphere(double radius, int sides) {
  std::vector<Ring> profile;
  for (const double latitude : even_angles(-kPi / 2.0, kPi / 2.0, sides / 2)) {
    profile.push_back({radius * std::cos(latitude), radius * std::sin(latitude)});
  }
  Lathe lathe(sides);
  lathe.turn(profile);
  return lathe.finished();
}

// With both caps; a cone where a radius is 0.
Surface cylinder(double bottom, double top, double height, int sides) {
  const double half = height / 2.0;
  const Ring lower{bottom, -half}, upper{top, half};
  Lathe lathe(sides);
  lathe.turn(std::vector<Ring>{{0.0, -half}, lower});
  lathe.turn(std::vector<Ring>{lower, upper});
  lathe.turn(std::vector<Ring>{upper, {0.0, half}});
  return lathe.finished();
}

// A cylinder of `height` between two half spheres.
Surface capsule(double bottom, double top, double height, int sides) {
  const std::vector<double> angles = even_angles(0.0, kPi / 2.0, sides / 4);
  const double half = height / 2.0;
  std::vector<Ring> profile;
  for (const double angle : angles) {
    profile.push_back({bottom * std::sin(angle), -half - bottom * std::cos(angle)});
  }
  for (const double angle : angles) profile.push_back({top * std::cos(angle), half + top * std::sin(angle)});
  Lathe lathe(sides);
  lathe.turn(profile);
  return lathe.finished();
}

// Every face has vertices of its own.
Surface cube(double size) {
  // Of each corner, which end of x (4), y (2) and z (1) it lies at.
  constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  const auto end = [size](bool upper) { return (upper ? 0.5 : -0.5) * size; };
  Surface surface;
  for (const auto& face : kFaces) {
    surface.counts.push_back(4);
    for (const int corner : face) {
      surface.indices.push_back(int(surface.points.size()));
      surface.points.push_back({end(corner & 4), end(corner & 2), end(corner & 1)});
    }
  }
  return surface;
}

// In xy, facing +z.
Surface plane(double width, double length) {
  const double x = width / 2.0, y = length / 2.0;
  return {{4}, {0, 1, 2, 3}, {{-x, -y, 0.0}, {x, -y, 0.0}, {x, y, 0.0}, {-x, y, 0.0}}};
}

Surface surface_along_z(ImplicitKind kind, std::span<const double> v, int sides) {
  switch (kind) {
    case ImplicitKind::kSphere:
      return sphere(v[0], sides);
    case ImplicitKind::kCube:
      return cube(v[0]);
    case ImplicitKind::kCone:
      return cylinder(v[0], 0.0, v[1], sides);
    case ImplicitKind::kCylinder:
      return cylinder(v[0], v[0], v[1], sides);
    case ImplicitKind::kCylinder1:
      return cylinder(v[0], v[1], v[2], sides);
    case ImplicitKind::kCapsule:
      return capsule(v[0], v[0], v[1], sides);
    case ImplicitKind::kCapsule1:
      return capsule(v[0], v[1], v[2], sides);
    case ImplicitKind::kPlane:
      return plane(v[0], v[1]);
  }
  return {};
}

}  // namespace

Vec3d turned(const Vec3d& p, Axis axis) {
  if (axis == Axis::kX) return {p.z, p.x, p.y};
  if (axis == Axis::kY) return {p.y, p.z, p.x};
  return p;
}

std::vector<double> values_along_z(ImplicitKind kind, std::span<const double> values, Axis axis) {
  std::vector<double> result(values.begin(), values.end());
  if (kind == ImplicitKind::kPlane && axis != Axis::kZ) std::swap(result[0], result[1]);
  return result;
}

Surface implicit_surface(ImplicitKind kind, std::span<const double> values, Axis axis, int sides) {
  Surface surface = surface_along_z(kind, values_along_z(kind, values, axis), sides);
  for (Vec3d& point : surface.points) point = turned(point, axis);
  return surface;
}

}  // namespace msbvh::translate
