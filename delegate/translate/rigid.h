// Rotations as quaternions, rigid motions as dual quaternions, and what of a matrix is neither.
//
// Kavan, Collins, Zara, O'Sullivan: "Skinning with Dual Quaternions" (I3D 2007), sections 3 and 4.
#pragma once

#include <optional>

#include "core/base/affine.h"
#include "core/base/vec.h"

namespace msbvh::translate {

struct Quaternion {
  double w = 0.0;
  Vec3d v;

  Quaternion& operator+=(const Quaternion& b) { return *this = {w + b.w, v + b.v}; }
};

inline Quaternion operator*(const Quaternion& q, double s) { return {q.w * s, q.v * s}; }
inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - dot(a.v, b.v), b.v * a.w + a.v * b.w + cross(a.v, b.v)};
}
inline double dot(const Quaternion& a, const Quaternion& b) { return a.w * b.w + dot(a.v, b.v); }

// A weighted sum of rigid motions: a rotation `real` of any length, and half the translation times it.
struct DualQuaternion {
  Quaternion real, dual;

  DualQuaternion& operator+=(const DualQuaternion& b) {
    real += b.real;
    dual += b.dual;
    return *this;
  }
};

inline DualQuaternion operator*(const DualQuaternion& q, double s) { return {q.real * s, q.dual * s}; }

// The rotation of the linear part of `map` (which must be one), of unit length; w or the largest component of
// v is positive.
Quaternion rotation_of(const Affine3d& rotation);

inline DualQuaternion rigid_motion(const Quaternion& rotation, const Vec3d& translation) {
  return {rotation, Quaternion{0.0, translation} * rotation * 0.5};
}

// A weighted sum made rigid again. One that cancels is the identity (GfDualQuatd::Normalize).
Affine3d rigid_map(const DualQuaternion& sum);

// map = rotation * stretch, then the translation: the polar decomposition, with a stretch of negative
// determinant for a map that mirrors, so that the rotation is proper.
struct PolarParts {
  Affine3d rotation;  // no translation
  Affine3d stretch;   // symmetric, no translation
};

// Nothing for a map that is singular: one that shrinks volumes by more than kSmallestVolume.
inline constexpr double kSmallestVolume = 1e-10;  // GfMatrix4d::Factor
std::optional<PolarParts> polar_parts(const Affine3d& map);

}  // namespace msbvh::translate
