// A boundary between two transparent bodies: it reflects and refracts, rough or smooth.
//
// B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, with visible
// normals. What goes to and fro between microfacets leaves on both sides (glass_tables.h). Radiance is
// counted over the square of the ior of where it is, so that a beam that crosses a body comes out as it went
// in; reciprocity has that square (`at`).
#pragma once

#include "core/shade/bsdf/bsdf.h"

namespace msbvh {

// Fresnel's reflectance for light of no polarisation. `ratio`: ior of the far side over that of the near one,
// where the cosine (at least 0) is.
float fresnel_dielectric(float cosine, float ratio);

// Of `out` through a microfacet, which must not reflect it totally.
Vec3f refracted(const Vec3f& out, const Vec3f& normal, float ratio);

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
  // `lobe` in [0, 1) says whether it leaves at once, and whether it is reflected.
  BsdfSample sample(const Vec3f& normal, float lobe, Point2 random) const;

 private:
  // By microfacets alone, and of what they leave behind; in the surface's space. The value is one channel's.
  struct Part {
    float value = 0.0f, pdf = 0.0f;
  };
  Part at_once(const Vec3f& in) const;
  Part later(const Vec3f& in) const;
  Vec3f direction(float lobe, Point2 random) const;

  Vec3f out_;  // in the surface's space
  float ratio_ = 1.5f, alpha_ = 1.0f;
  // Of light that does not leave at once: the share of all, and what of it is reflected.
  float late_ = 0.0f, late_reflected_ = 1.0f;
  float late_near_ = 0.0f,
        late_far_ = 0.0f;  // lobes of it on both sides, by cosine and what is missing there
};

}  // namespace msbvh
