// From the unit square to the domains that a path tracer samples.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
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

// Sine and cosine of an angle in [-pi/4, pi/4], to 2 roundings: the terms of their series that a float can
// tell from 0. Without a reduction of the angle, which is what the library's functions spend most of their
// time on.
inline void small_angle(float x, float& sine, float& cosine) {
  const float x2 = x * x;
  sine = x + x * x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880))));
  cosine = 1.0f + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
}

// Uniform in the unit disc, with neighbours kept together: squares about the centre become circles. P.
// Shirley and K. Chiu, "A Low Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997.
inline Point2 sample_disc(Point2 p) {
  const float x = 2.0f * p.x - 1.0f, y = 2.0f * p.y - 1.0f;
  // By masks: the branch would be taken by chance.
  const std::uint32_t wide = 0u - static_cast<std::uint32_t>(std::abs(x) > std::abs(y));
  const auto choose = [wide](float a, float b) {
    return std::bit_cast<float>((std::bit_cast<std::uint32_t>(a) & wide) |
                                (std::bit_cast<std::uint32_t>(b) & ~wide));
  };
  const float radius = choose(x, y), other = choose(y, x);
  if (radius == 0.0f) return {0.0f, 0.0f};
  float sine, cosine;
  small_angle((kPi / 4.0f) * (other / radius), sine, cosine);
  const float along = radius * cosine, across = radius * sine;
  return {choose(along, across), choose(across, along)};
}

// About +z with density cos(theta) / pi: over a uniform point of the disc.
inline Vec3f sample_cosine_hemisphere(Point2 p) {
  const Point2 d = sample_disc(p);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}

// Uniform in the cone about +z whose half angle a is given by 1 - cos(a): the difference itself, since it
// loses all its digits for small cones when it is formed from the cosine. Its solid angle is 2 pi (1 -
// cos(a)). A point of the disc at the radius r goes to where 1 - cos is r^2 of that.
inline Vec3f sample_cone(Point2 p, float one_minus_cos_max) {
  const Point2 d = sample_disc(p);
  const float one_minus_cos = (d.x * d.x + d.y * d.y) * one_minus_cos_max;
  const float scale = std::sqrt(std::max(0.0f, one_minus_cos_max * (2.0f - one_minus_cos)));
  return {d.x * scale, d.y * scale, 1.0f - one_minus_cos};
}

}  // namespace msbvh
