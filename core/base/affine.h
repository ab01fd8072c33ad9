// Affine maps as three columns of the linear part and a translation: p -> x * p.x + y * p.y + z * p.z + t.
// Names say both spaces: world_from_object maps object coordinates to world coordinates.
#pragma once

#include "core/base/vec.h"

namespace msbvh {

template <typename T>
struct Affine3 {
  Vec3<T> x{T(1), T(0), T(0)};
  Vec3<T> y{T(0), T(1), T(0)};
  Vec3<T> z{T(0), T(0), T(1)};
  Vec3<T> t{};

  constexpr Affine3() = default;
  constexpr Affine3(const Vec3<T>& x_, const Vec3<T>& y_, const Vec3<T>& z_, const Vec3<T>& t_)
      : x(x_), y(y_), z(z_), t(t_) {}
  template <typename U>
  constexpr explicit Affine3(const Affine3<U>& a) : x(a.x), y(a.y), z(a.z), t(a.t) {}

  constexpr Vec3<T> vector(const Vec3<T>& v) const { return x * v.x + y * v.y + z * v.z; }
  constexpr Vec3<T> point(const Vec3<T>& p) const { return vector(p) + t; }
  constexpr T determinant() const { return dot(x, cross(y, z)); }
  constexpr bool operator==(const Affine3&) const = default;
};

using Affine3f = Affine3<float>;
using Affine3d = Affine3<double>;

template <typename T>
constexpr Affine3<T> operator*(const Affine3<T>& a, const Affine3<T>& b) {
  return {a.vector(b.x), a.vector(b.y), a.vector(b.z), a.point(b.t)};
}

// Normals move by the cofactor matrix, which exists for singular maps too and keeps the right side of a
// mirror: cofactor(A) = det(A) * inverse(A)^T. The result is not normalised.
template <typename T>
constexpr Vec3<T> transform_normal(const Affine3<T>& a, const Vec3<T>& n) {
  return cross(a.y, a.z) * n.x + cross(a.z, a.x) * n.y + cross(a.x, a.y) * n.z;
}

template <typename T>
bool is_finite(const Affine3<T>& a) {
  return is_finite(a.x) && is_finite(a.y) && is_finite(a.z) && is_finite(a.t);
}

// Inverse by cofactors. The determinant of `a` must not be zero: callers reject singular maps first.
template <typename T>
constexpr Affine3<T> inverse(const Affine3<T>& a) {
  const Vec3<T> rx = cross(a.y, a.z), ry = cross(a.z, a.x), rz = cross(a.x, a.y);
  const T s = T(1) / dot(a.x, rx);
  Affine3<T> r{
      Vec3<T>{rx.x, ry.x, rz.x} * s, Vec3<T>{rx.y, ry.y, rz.y} * s, Vec3<T>{rx.z, ry.z, rz.z} * s, {}};
  r.t = -r.vector(a.t);
  return r;
}

}  // namespace msbvh
