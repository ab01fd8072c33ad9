#include "core/shade/bsdf/glass.h"

#include <algorithm>
#include <cmath>

#include "core/shade/bsdf/microfacet.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr float kLeastCosine = 1e-4f;  // as of Bsdf: directions that leave

// Of `out` through a microfacet; it must not be reflected totally. J. de Greve, "Reflections and Refractions
// in Ray Tracing", 2006.
Vec3f refracted(const Vec3f& out, const Vec3f& normal, float ratio) {
  const float cosine = dot(out, normal), inverse = 1.0f / ratio;
  const float far2 = 1.0f - (1.0f - cosine * cosine) * inverse * inverse;
  return normalize(normal * (cosine * inverse - std::sqrt(std::max(0.0f, far2))) - out * inverse);
}

Bsdf::Value grey(float value, float pdf) { return {{}, {value, value, value}, pdf}; }

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

Glass::Glass(float ratio, float alpha, const Vec3f& normal, const Vec3f& out) : ratio_(ratio), alpha_(alpha) {
  const Basis basis(normal);
  out_ = {dot(out, basis.x), dot(out, basis.y), dot(out, basis.z)};
  if (out_.z < kLeastCosine) out_ = normalize(Vec3f{out_.x, out_.y, kLeastCosine});
}

// Of the microfacet's normals that `out` sees, the share that sends light on to `in`. What leaves is the
// share of it that is not hidden from there.
Bsdf::Value Glass::at(const Vec3f& normal, const Vec3f& in_world) const {
  const Basis basis(normal);
  const Vec3f in{dot(in_world, basis.x), dot(in_world, basis.y), dot(in_world, basis.z)};
  if (in.z == 0.0f) return grey(0.0f, 0.0f);
  Vec3f facet = in.z > 0.0f ? out_ + in : out_ + in * ratio_;
  const float size = length(facet);
  if (!(size > 0.0f)) return grey(0.0f, 0.0f);
  facet = facet * ((facet.z < 0.0f ? -1.0f : 1.0f) / size);
  const float near = dot(out_, facet), far = dot(in, facet);
  if (near <= 0.0f || far * in.z <= 0.0f) return grey(0.0f, 0.0f);
  const float seen = smith_visible(out_, alpha_), both = smith_visible(out_, in, alpha_);
  const float mirrored_share = fresnel_dielectric(near, ratio_);
  float pdf = seen * ggx_density(facet, alpha_) / out_.z;
  if (in.z > 0.0f) {
    pdf *= mirrored_share * 0.25f;
  } else {
    const float way = near + ratio_ * far;
    pdf *= (1.0f - mirrored_share) * near * ratio_ * ratio_ * -far / (way * way);
  }
  return grey(pdf * (both / seen), pdf);
}

BsdfSample Glass::sample(const Vec3f& normal, float lobe, Point2 random) const {
  const Vec3f facet = sample_visible_normal(out_, alpha_, random);
  const float near = dot(out_, facet);
  if (near <= 0.0f) return {};
  const float mirrored_share = fresnel_dielectric(near, ratio_);
  const bool mirrors = lobe < mirrored_share;
  const Vec3f in = mirrors ? mirrored(out_, facet) : refracted(out_, facet, ratio_);
  if (mirrors ? in.z <= 0.0f : in.z >= 0.0f) return {};
  const float seen = smith_visible(out_, alpha_), weight = smith_visible(out_, in, alpha_) / seen;
  float pdf = seen * ggx_density(facet, alpha_) / out_.z;
  if (mirrors) {
    pdf *= mirrored_share * 0.25f;
  } else {
    const float far = dot(in, facet), way = near + ratio_ * far;
    pdf *= (1.0f - mirrored_share) * near * ratio_ * ratio_ * -far / (way * way);
  }
  if (!(pdf > 0.0f) || !std::isfinite(pdf)) return {};
  const Vec3f white{weight, weight, weight};
  return {Basis(normal)(in), pdf, white, white};
}

}  // namespace msbvh
