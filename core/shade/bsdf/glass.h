// A boundary between two transparent bodies: it reflects and refracts, rough or smooth.
//
// B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, with visible
// normals. Light that goes to and fro between microfacets is left out. Radiance is counted over the square
// of the ior of where it is, so that a beam that crosses a body comes out as it went in, and what is inside
// of glass needs no factor; densities and reciprocity have that square (`at`).
#pragma once

#include "core/shade/bsdf/bsdf.h"

namespace msbvh {

// Fresnel's reflectance for light of no polarisation. `ratio`: ior of the far side over that of the near one,
// where the cosine (at least 0) is.
float fresnel_dielectric(float cosine, float ratio);

// As Bsdf is, for light on both sides.
class Glass {
 public:
  Glass() = default;
  // `ratio`: as above, not 1: then no direction says which microfacet light went through. `normal`: on the
  // side of `out`.
  Glass(float ratio, float alpha, const Vec3f& normal, const Vec3f& out);

  // All of it is `specular`. Below the surface, ratio^2 times as much as for light that goes back the same
  // way.
  Bsdf::Value at(const Vec3f& normal, const Vec3f& in) const;
  // `lobe` in [0, 1) says whether it is reflected.
  BsdfSample sample(const Vec3f& normal, float lobe, Point2 random) const;

 private:
  Vec3f out_;  // in the surface's space
  float ratio_ = 1.5f, alpha_ = 1.0f;
};

}  // namespace msbvh
