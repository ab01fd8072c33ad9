#include "core/shade/bsdf/fibre.h"

#include <algorithm>
#include <cmath>

#include "core/shade/bsdf/glass.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// Below it densities along the hair are beyond what single precision resolves.
constexpr float kLeastRoughness = 0.05f;
// Light must get into a hair.
constexpr float kLeastIor = 1.01f;
// From where on sinh(1 / v) is as good as exp(1 / v) / 2, and would overflow.
constexpr float kNarrow = 0.1f;

float squared(float x) { return x * x; }
float root(float x) { return std::sqrt(std::max(0.0f, x)); }

// The modified Bessel function of order 0, by its power series: within 1e-6 for |x| < 12.
float bessel(float x) {
  const float quarter = 0.25f * x * x;
  float sum = 1.0f, term = 1.0f;
  for (int k = 1; k < 30; ++k) {
    term *= quarter / float(k * k);
    sum += term;
  }
  return sum;
}
// Its logarithm, by its asymptotic series where the other would overflow.
float log_bessel(float x) {
  if (x > 12.0f) return x - 0.5f * std::log(2.0f * kPi * x) + (0.125f + 0.0625f / x) / x;
  return std::log(bessel(x));
}

// Along the hair, per radian of inclination times its cosine: E. d'Eon et al., "An Energy-Conserving Hair
// Reflectance Model", EGSR 2011. Both sines of two directions that mirror each other have opposite signs.
float along_hair(float in_sine, float in_cosine, float out_sine, float out_cosine, float v) {
  const float a = in_cosine * out_cosine / v, b = in_sine * out_sine / v;
  if (v <= kNarrow) return std::exp(log_bessel(a) - b - 1.0f / v + 0.6931472f + std::log(0.5f / v));
  return std::exp(-b) * bessel(a) / (std::sinh(1.0f / v) * 2.0f * v);
}

float logistic_sum(float x, float scale) { return 1.0f / (1.0f + std::exp(-x / scale)); }

// Round the hair, per radian: a logistic distribution cut off at half a turn either way.
float round_hair(float angle, float scale) {
  const float turned = std::remainder(angle, 2.0f * kPi);
  const float e = std::exp(-std::abs(turned) / scale);
  return e / (scale * squared(1.0f + e)) / (logistic_sum(kPi, scale) - logistic_sum(-kPi, scale));
}
float sample_round_hair(float random, float scale) {
  const float least = logistic_sum(-kPi, scale), share = logistic_sum(kPi, scale) - least;
  return std::clamp(-scale * std::log(1.0f / (random * share + least) - 1.0f), -kPi, kPi);
}

Vec3f passed(const Vec3f& absorption, float way) {
  return {std::exp(-absorption.x * way), std::exp(-absorption.y * way), std::exp(-absorption.z * way)};
}

float mean_of(const Vec3f& color) { return (color.x + color.y + color.z) * (1.0f / 3.0f); }

// Of what is reflected once more and more inside of the hair, all together: a geometric series.
Vec3f all_further(const Vec3f& last, const Vec3f& each) {
  const auto one = [](float a, float q) { return a * q / std::max(1e-6f, 1.0f - q); };
  return {one(last.x, each.x), one(last.y, each.y), one(last.z, each.z)};
}

}  // namespace

Vec3f fibre_absorption(const Vec3f& color, float round) {
  const float b = std::clamp(round, kLeastRoughness, 1.0f), b2 = b * b;
  const float fit =
      5.969f - 0.215f * b + 2.532f * b2 - 10.73f * b2 * b + 5.574f * b2 * b2 + 0.245f * b2 * b2 * b;
  const auto one = [&](float c) { return squared(std::log(std::clamp(c, 1e-3f, 1.0f)) / fit); };
  return {one(color.x), one(color.y), one(color.z)};
}

Fibre::Fibre(const FibreLook& look, const Vec3f& tangent, const Vec3f& normal, const Vec3f& out) {
  x_ = normalize(tangent);
  if (!(dot(x_, x_) > 0.5f))
    x_ = Basis(normal).x;  // a span whose points are all in one place has no direction
  const float sine = std::clamp(dot(out, x_), -1.0f, 1.0f), cosine = root(1.0f - sine * sine);
  const Vec3f across = out - x_ * sine;
  y_ = dot(across, across) > 1e-12f ? normalize(across) : Basis(x_).x;
  z_ = cross(x_, y_);
  const float front = dot(normal, y_), aside = dot(normal, z_), wide = std::hypot(front, aside);
  const float offset = wide > 0.0f ? std::clamp(-aside / wide, -1.0f, 1.0f) : 0.0f;

  // Inside: how steep, and at which angle to the wall.
  const float ior = std::max(kLeastIor, look.ior);
  const float inner_cosine = root(1.0f - squared(sine / ior));
  const float inner_offset = offset * cosine / root(ior * ior - sine * sine);
  const float outer_angle = std::asin(offset), inner_angle = std::asin(std::clamp(inner_offset, -1.0f, 1.0f));
  const Vec3f through = passed(look.absorption, 2.0f * root(1.0f - squared(inner_offset)) / inner_cosine);
  const float mirrored_share = fresnel_dielectric(cosine * root(1.0f - offset * offset), ior);
  const float enters = 1.0f - mirrored_share;
  share_[0] = {mirrored_share, mirrored_share, mirrored_share};
  share_[1] = through * (enters * enters);
  share_[2] = share_[1] * through * mirrored_share;
  share_[3] = all_further(share_[2], through * mirrored_share);
  for (const Vec3f& share : share_) albedo_ += share;
  const float all = mean_of(albedo_);
  for (std::size_t p = 0; p < kLobes; ++p) {
    chance_[p] = all > 0.0f ? mean_of(share_[p]) / all : 0.0f;
    turn_[p] = 2.0f * float(p) * inner_angle - 2.0f * outer_angle + float(p) * kPi;
  }
  set_widths(look, sine, cosine);
}

void Fibre::set_widths(const FibreLook& look, float sine, float cosine) {
  const float along = std::clamp(look.along, kLeastRoughness, 1.0f);
  const float round = std::clamp(look.round, kLeastRoughness, 1.0f);
  const float v = squared(0.726f * along + 0.812f * along * along + 3.7f * std::pow(along, 20.0f));
  spread_ = {v, 0.25f * v, 4.0f * v, 4.0f * v};
  scale_ = 0.626657069f * (0.265f * round + 1.194f * round * round + 5.372f * std::pow(round, 22.0f));
  // Scales turn R by twice their tilt one way, TT by it and TRT by four times it the other way.
  const float tilt = look.tilt_degrees * (kPi / 180.0f),
              turned[kLobes] = {-2.0f * tilt, tilt, 4.0f * tilt, 0};
  for (std::size_t p = 0; p < kLobes; ++p) {
    const float s = std::sin(turned[p]), c = std::cos(turned[p]);
    sine_[p] = sine * c + cosine * s;
    cosine_[p] = std::abs(cosine * c - sine * s);
  }
}

Bsdf::Value Fibre::at_angles(float sine, float cosine, float phi) const {
  Bsdf::Value value{{}, {}, 0.0f};
  for (std::size_t p = 0; p < kLobes; ++p) {
    const float round = p + 1 < kLobes ? round_hair(phi - turn_[p], scale_) : 0.5f / kPi;
    const float density = along_hair(sine, cosine, sine_[p], cosine_[p], spread_[p]) * round;
    value.specular += share_[p] * density;
    value.pdf += chance_[p] * density;
  }
  return value;
}

Bsdf::Value Fibre::at(const Vec3f& in) const {
  const float sine = std::clamp(dot(in, x_), -1.0f, 1.0f);
  return at_angles(sine, root(1.0f - sine * sine), std::atan2(dot(in, z_), dot(in, y_)));
}

BsdfSample Fibre::sample(float lobe, Point2 random) const {
  std::size_t p = 0;
  float below = 0.0f;
  while (p + 1 < kLobes && lobe >= below + chance_[p]) below += chance_[p++];
  if (!(chance_[p] > 0.0f)) return {};
  const float again = std::clamp((lobe - below) / chance_[p], 0.0f, 0x1.fffffep-1f);
  const float v = spread_[p];
  const float least = std::max(random.x + (1.0f - random.x) * std::exp(-2.0f / v), 1e-30f);
  const float off = std::clamp(1.0f + v * std::log(least), -1.0f, 1.0f);
  const float sine = std::clamp(
      -off * sine_[p] + root(1.0f - off * off) * std::cos(2.0f * kPi * random.y) * cosine_[p], -1.0f, 1.0f);
  const float cosine = root(1.0f - sine * sine);
  const float phi = p + 1 < kLobes ? turn_[p] + sample_round_hair(again, scale_) : 2.0f * kPi * again;
  const Bsdf::Value value = at_angles(sine, cosine, phi);
  if (!(value.pdf > 0.0f) || !std::isfinite(value.pdf)) return {};
  const Vec3f weight = value.specular * (1.0f / value.pdf);
  return {x_ * sine + (y_ * std::cos(phi) + z_ * std::sin(phi)) * cosine, value.pdf, weight, weight};
}

}  // namespace msbvh
