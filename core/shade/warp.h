// From the unit square to the domains that a path tracer samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/vec.h"
#include "core/shade/point2.h"

namespace msbvh {

inline constexpr float kPi = std::numbers::pi_v<float>;

// Two unit vectors that complete the unit vector z to a right-handed orthonormal basis.
// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
struct Basis {
  Vec3f x, y, z;
  explicit Basis(const Vec3f& normal) : z(normal) {
    const float sign = std::copysign(1.0f, z.z);
    const float a = -1.0f / (sign + z.z);
    const float b = z.x * z.y * a;
    x = {1.0f + sign * z.x * z.x * a, sign * b, -sign * z.x};
    y = {b, sign + z.y * z.y * a, -z.y};
  }
  Vec3f operator()(const Vec3f& local) const { return x * local.x + y * local.y + z * local.z; }
};

// Uniform in the unit disc, with neighbours kept together: squares about the centre become circles. P.
// Shirley and K. Chiu, "A Low Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997.
inline Point2 sample_disc(Point2 p) {
  const float x = 2.0f * p.x - 1.0f, y = 2.0f * p.y - 1.0f;
  if (x == 0.0f && y == 0.0f) return {0.0f, 0.0f};
  const bool wide = std::abs(x) > std::abs(y);
  const float radius = wide ? x : y;
  const float phi = wide ? (kPi / 4.0f) * (y / x) : (kPi / 2.0f) - (kPi / 4.0f) * (x / y);
  return {radius * std::cos(phi), radius * std::sin(phi)};
}

// About +z with density cos(theta) / pi.
inline Vec3f sample_cosine_hemisphere(Point2 p) {
  const float radius = std::sqrt(p.x), phi = 2.0f * kPi * p.y;
  return {radius * std::cos(phi), radius * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - p.x))};
}

// Uniform in the cone about +z whose half angle a is given by 1 - cos(a): the difference itself, since it
// loses all its digits for small cones when it is formed from the cosine. Its solid angle is 2 pi (1 -
// cos(a)).
inline Vec3f sample_cone(Point2 p, float one_minus_cos_max) {
  const float one_minus_cos = p.x * one_minus_cos_max;
  const float sine = std::sqrt(std::max(0.0f, one_minus_cos * (2.0f - one_minus_cos)));
  const float phi = 2.0f * kPi * p.y;
  return {sine * std::cos(phi), sine * std::sin(phi), 1.0f - one_minus_cos};
}

}  // namespace msbvh
