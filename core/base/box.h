// Axis-aligned boxes. An empty box has lo = +inf and hi = -inf, so that growing needs no special case.
#pragma once

#include <limits>

#include "core/base/vec.h"

namespace msbvh {

template <typename T>
struct Box3 {
  Vec3<T> lo{std::numeric_limits<T>::infinity(), std::numeric_limits<T>::infinity(),
             std::numeric_limits<T>::infinity()};
  Vec3<T> hi{-std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity(),
             -std::numeric_limits<T>::infinity()};

  constexpr bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  constexpr void grow(const Vec3<T>& p) {
    lo = min(lo, p);
    hi = max(hi, p);
  }
  constexpr void grow(const Box3& b) {
    lo = min(lo, b.lo);
    hi = max(hi, b.hi);
  }
  constexpr Vec3<T> extent() const { return hi - lo; }
  constexpr Vec3<T> center() const { return (lo + hi) * T(0.5); }
  constexpr bool contains(const Vec3<T>& p) const {
    return p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x <= hi.x && p.y <= hi.y && p.z <= hi.z;
  }
  constexpr bool contains(const Box3& b) const { return b.empty() || (contains(b.lo) && contains(b.hi)); }
  constexpr bool operator==(const Box3&) const = default;
};

using Box3f = Box3<float>;
using Box3d = Box3<double>;

template <typename T>
constexpr Box3<T> intersect(const Box3<T>& a, const Box3<T>& b) {
  return {max(a.lo, b.lo), min(a.hi, b.hi)};
}

// Half the surface area: the measure of the SAH (a constant factor cancels). 0 for an empty box.
template <typename T>
constexpr T half_area(const Box3<T>& b) {
  if (b.empty()) return T(0);
  const Vec3<T> e = b.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

}  // namespace msbvh
