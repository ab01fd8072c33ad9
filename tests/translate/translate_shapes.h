// What the tests of implicit shapes measure.
#pragma once

#include <array>
#include <vector>

#include "core/base/affine.h"
#include "core/base/box.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/shape/surface.h"

namespace msbvh::translate::testing {

using Values = std::vector<double>;

inline constexpr std::array kAxes = {Axis::kX, Axis::kY, Axis::kZ};
inline constexpr std::array kKinds = {
    ImplicitKind::kSphere,    ImplicitKind::kCube,    ImplicitKind::kCone,     ImplicitKind::kCylinder,
    ImplicitKind::kCylinder1, ImplicitKind::kCapsule, ImplicitKind::kCapsule1, ImplicitKind::kPlane};

inline Box3d box_of(const Surface& surface) {
  Box3d box;
  for (const Vec3d& point : surface.points) box.grow(point);
  return box;
}

inline Matrix4d matrix_of(const Affine3d& a) {
  return {a.x.x, a.x.y, a.x.z, 0.0, a.y.x, a.y.y, a.y.z, 0.0,
          a.z.x, a.z.y, a.z.z, 0.0, a.t.x, a.t.y, a.t.z, 1.0};
}

inline Affine3d scaled(double x, double y, double z, const Vec3d& to = {}) {
  return {{x, 0.0, 0.0}, {0.0, y, 0.0}, {0.0, 0.0, z}, to};
}

}  // namespace msbvh::translate::testing
