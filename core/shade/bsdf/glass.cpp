#include "core/shade/bsdf/glass.h"

#include <algorithm>
#include <cmath>

#include "core/shade/bsdf/glass_tables.h"
#include "core/shade/bsdf/microfacet.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr float kLeastCosine = 1e-4f;  // as of Bsdf: directions that leave
constexpr float kLeastMean = 1e-7f;    // of what is missing, below which nothing is

}  // namespace

float fresnel_dielectric(float cosine, float ratio) {
  const float near = std::clamp(cosine, 0.0f, 1.0f);
  const float far2 = 1.0f - (1.0f - near * near) / (ratio * ratio);
  if (far2 <= 0.0f) return 1.0f;  // total reflection
  const float far = std::sqrt(far2);
  const float across = (ratio * near - far) / (ratio * near + far);
  const float along = (near - ratio * far) / (near + ratio * far);
  return 0.5f * (across * across + along * along);
}

// J. de Greve, "Reflections and Refractions in Ray Tracing", 2006.
Vec3f refracted(const Vec3f& out, const Vec3f& normal, float ratio) {
  const float cosine = dot(out, normal), inverse = 1.0f / ratio;
  const float far2 = 1.0f - (1.0f - cosine * cosine) * inverse * inverse;
  return normalize(normal * (cosine * inverse - std::sqrt(std::max(0.0f, far2))) - out * inverse);
}

Glass::Glass(float ratio, float alpha, const Vec3f& normal, const Vec3f& out) : ratio_(ratio), alpha_(alpha) {
  const Basis basis(normal);
  out_ = {dot(out, basis.x), dot(out, basis.y), dot(out, basis.z)};
  if (out_.z < kLeastCosine) out_ = normalize(Vec3f{out_.x, out_.y, kLeastCosine});
  const GlassTables& tables = GlassTables::get();
  late_ = tables.missing(out_.z, alpha, ratio);
  late_reflected_ = tables.reflected_share(alpha, ratio);
  const float per_near = kPi * std::max(kLeastMean, tables.mean_missing(alpha, ratio));
  const float per_far = kPi * std::max(kLeastMean, tables.mean_missing(alpha, 1.0f / ratio));
  late_near_ = late_ * late_reflected_ / per_near;
  late_far_ = late_ * (1.0f - late_reflected_) / per_far;
}

// Of the microfacet's normals that `out` sees, the share that sends light on to `in`. What leaves is the
// share of it that is not hidden from there.
Glass::Part Glass::at_once(const Vec3f& in) const {
  Vec3f facet = in.z > 0.0f ? out_ + in : out_ + in * ratio_;
  const float size = length(facet);
  if (!(size > 0.0f)) return {};
  facet = facet * ((facet.z < 0.0f ? -1.0f : 1.0f) / size);
  const float near = dot(out_, facet), far = dot(in, facet);
  if (near <= 0.0f || far * in.z <= 0.0f) return {};
  const float seen = smith_visible(out_, alpha_), mirrored_share = fresnel_dielectric(near, ratio_);
  float pdf = seen * ggx_density(facet, alpha_) / out_.z;
  if (in.z > 0.0f) {
    pdf *= mirrored_share * 0.25f;
  } else {
    const float way = near + ratio_ * far;
    pdf *= (1.0f - mirrored_share) * near * ratio_ * ratio_ * -far / (way * way);
  }
  return {pdf * (smith_visible(out_, in, alpha_) / seen), pdf};
}

Glass::Part Glass::later(const Vec3f& in) const {
  const float cosine = std::abs(in.z), share = in.z > 0.0f ? late_reflected_ : 1.0f - late_reflected_;
  const float missing = GlassTables::get().missing(cosine, alpha_, in.z > 0.0f ? ratio_ : 1.0f / ratio_);
  return {(in.z > 0.0f ? late_near_ : late_far_) * missing * cosine, share * cosine * (1.0f / kPi)};
}

Bsdf::Value Glass::at(const Vec3f& normal, const Vec3f& in_world) const {
  const Basis basis(normal);
  const Vec3f in{dot(in_world, basis.x), dot(in_world, basis.y), dot(in_world, basis.z)};
  if (in.z == 0.0f) return {{}, {}, 0.0f};
  const Part first = at_once(in), rest = later(in);
  const float value = first.value + rest.value;
  return {{}, {value, value, value}, (1.0f - late_) * first.pdf + late_ * rest.pdf};
}

// 0: none.
Vec3f Glass::direction(float lobe, Point2 random) const {
  if (lobe < late_) {
    const Vec3f up = sample_cosine_hemisphere(random);
    return lobe < late_ * late_reflected_ ? up : Vec3f{up.x, up.y, -up.z};
  }
  const Vec3f facet = sample_visible_normal(out_, alpha_, random);
  const float near = dot(out_, facet);
  if (near <= 0.0f) return {};
  const float mirrored_share = fresnel_dielectric(near, ratio_);
  const bool mirrors = lobe - late_ < (1.0f - late_) * mirrored_share;
  const Vec3f in = mirrors ? mirrored(out_, facet) : refracted(out_, facet, ratio_);
  return (mirrors ? in.z > 0.0f : in.z < 0.0f) ? in : Vec3f{};
}

BsdfSample Glass::sample(const Vec3f& normal, float lobe, Point2 random) const {
  const Vec3f in = direction(lobe, random);
  if (in.z == 0.0f) return {};
  const Part first = at_once(in), rest = later(in);
  const float pdf = (1.0f - late_) * first.pdf + late_ * rest.pdf;
  if (!(pdf > 0.0f) || !std::isfinite(pdf)) return {};
  const float weight = (first.value + rest.value) / pdf;
  const Vec3f white{weight, weight, weight};
  return {Basis(normal)(in), pdf, white, white};
}

}  // namespace msbvh
