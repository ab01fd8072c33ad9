// The GGX distribution of microfacets about +z, with Smith's shadowing. Directions are unit vectors in the
// space of the surface, whose normal is +z.
//
// B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007; E. Heitz,
// "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/vec.h"
#include "core/shade/point2.h"
#include "core/shade/warp.h"

namespace msbvh {

// A mirror is drawn this rough: single precision resolves no density above.
inline constexpr float kLeastAlpha = 1e-3f;

// From a roughness in [0, 1], as UsdPreviewSurface means it.
inline float alpha_of(float roughness) { return std::max(kLeastAlpha, roughness * roughness); }

// Density of microfacet normals, per steradian of projected area.
inline float ggx_density(const Vec3f& normal, float alpha) {
  // In this form nothing cancels where the surface is nearly a mirror.
  const float a2 = alpha * alpha;
  const float spread = normal.x * normal.x + normal.y * normal.y + a2 * normal.z * normal.z;
  return a2 / (kPi * spread * spread);
}

// Smith's Lambda: hidden over visible area of the microfacets, seen from a direction above the surface.
inline float smith_lambda(const Vec3f& direction, float alpha) {
  const float z2 = direction.z * direction.z;
  const float tangent2 = (direction.x * direction.x + direction.y * direction.y) / z2;
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tangent2) - 1.0f);
}

// Share of microfacets that are visible from one direction, and from two (height-correlated).
inline float smith_visible(const Vec3f& out, float alpha) { return 1.0f / (1.0f + smith_lambda(out, alpha)); }
inline float smith_visible(const Vec3f& out, const Vec3f& in, float alpha) {
  return 1.0f / (1.0f + smith_lambda(out, alpha) + smith_lambda(in, alpha));
}

// A microfacet normal, as likely as it is seen from `out`. J. Dupuy and A. Benyoub, "Sampling Visible GGX
// Normals with Spherical Caps", HPG 2023.
inline Vec3f sample_visible_normal(const Vec3f& out, float alpha, Point2 random) {
  const Vec3f stretched = normalize(Vec3f{alpha * out.x, alpha * out.y, out.z});
  const float phi = 2.0f * kPi * random.x;
  const float z = (1.0f - random.y) * (1.0f + stretched.z) - stretched.z;
  const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const Vec3f cap{radius * std::cos(phi) + stretched.x, radius * std::sin(phi) + stretched.y,
                  z + stretched.z};
  return normalize(Vec3f{alpha * cap.x, alpha * cap.y, std::max(0.0f, cap.z)});
}

// Of the direction that a visible normal mirrors `out` to, per steradian.
inline float mirrored_density(const Vec3f& out, const Vec3f& normal, float alpha) {
  return smith_visible(out, alpha) * ggx_density(normal, alpha) / (4.0f * out.z);
}

inline Vec3f mirrored(const Vec3f& out, const Vec3f& normal) {
  return normal * (2.0f * dot(out, normal)) - out;
}

// (1 - cos)^5: Schlick's share of the reflectance at grazing incidence.
inline float schlick_weight(float cosine) {
  const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f), m2 = m * m;
  return m2 * m2 * m;
}

}  // namespace msbvh
