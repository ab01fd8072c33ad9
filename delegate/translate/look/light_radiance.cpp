#include "delegate/translate/look/light_radiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace msbvh::translate {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3d axis(const Matrix4d& m, std::size_t row) { return {m[4 * row], m[4 * row + 1], m[4 * row + 2]}; }

// Knud Thomsen's formula for ellipsoids, exact for spheres, otherwise within 1.1 %.
double ellipsoid_area(double a, double b, double c) {
  constexpr double kP = 1.6075;
  const double mean = (std::pow(a * b, kP) + std::pow(a * c, kP) + std::pow(b * c, kP)) / 3.0;
  return 4.0 * kPi * std::pow(mean, 1.0 / kP);
}

// Ramanujan's formula, exact for circles.
double ellipse_perimeter(double a, double b) {
  return kPi * (3.0 * (a + b) - std::sqrt((3.0 * a + b) * (a + 3.0 * b)));
}

// Of a disc of directions, by their cosine to its middle.
double weighted_solid_angle(double angle_degrees) {
  const double half = angle_degrees * kPi / 360.0, sine = std::sin(half);
  return kPi * (half <= kPi / 2.0 ? sine * sine : 2.0 - sine * sine);
}

double size_of(LightKind kind, const LightNumbers& sizes, const Matrix4d& m) {
  switch (kind) {
    case LightKind::kSphere:
      return ellipsoid_area(sizes.radius * length(axis(m, 0)), sizes.radius * length(axis(m, 1)),
                            sizes.radius * length(axis(m, 2)));
    case LightKind::kRect:
      return sizes.width * sizes.height * length(cross(axis(m, 0), axis(m, 1)));
    case LightKind::kDisk:
      return kPi * sizes.radius * sizes.radius * length(cross(axis(m, 0), axis(m, 1)));
    case LightKind::kCylinder:
      return sizes.length * length(axis(m, 0)) *
             ellipse_perimeter(sizes.radius * length(axis(m, 1)), sizes.radius * length(axis(m, 2)));
    case LightKind::kDistant:
      return weighted_solid_angle(sizes.angle_degrees);
    default:
      return 1.0;
  }
}

}  // namespace

LightValues light_values(const Vec3d& radiance, const LightNumbers& numbers) {
  LightValues values;
  values.radiance = Vec3f(radiance);
  for (const LightNumber& each : kLightNumbers) values.*each.value = float(numbers.*each.number);
  // std::max keeps a NaN that comes first, for the checks.
  values.focus = std::max(values.focus, 0.0f);
  values.cone_angle_degrees = std::max(values.cone_angle_degrees, 0.0f);
  if (values.cone_softness < 0.0f) values.cone_softness = 0.0f;
  if (values.cone_softness > 1.0f) values.cone_softness = 1.0f;
  return values;
}

Vec3d light_emission(double intensity, double exposure, const Vec3d& color, const Vec3d& temperature) {
  const double strength = intensity * std::exp2(exposure);
  return {strength * color.x * temperature.x, strength * color.y * temperature.y,
          strength * color.z * temperature.z};
}

double light_normalization(LightKind kind, const LightNumbers& sizes, const Matrix4d& world_from_light) {
  const double size = size_of(kind, sizes, world_from_light);
  return size > 0.0 ? size : 1.0;
}

Vec3d light_radiance(LightKind kind, const Vec3d& emission, const LightNumbers& sizes, bool normalize,
                     const Matrix4d& world_from_light) {
  const double divisor = normalize ? light_normalization(kind, sizes, world_from_light) : 1.0;
  // Radiant intensity: what a small normalised sphere, pi r^2 L / (4 pi r^2), tends to.
  const double share = kind == LightKind::kSphere && sizes.radius == 0.0 ? 0.25 : 1.0;
  return {emission.x / divisor * share, emission.y / divisor * share, emission.z / divisor * share};
}

}  // namespace msbvh::translate
