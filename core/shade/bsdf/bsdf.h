// How a surface reflects: UsdPreviewSurface's three lobes over each other.
//
// From above: a clear coat (white, GGX), a specular lobe (GGX under Schlick's Fresnel term), and what is
// diffuse. Each lobe gets what the ones above let through, both ways, so that the whole is reciprocal and
// never reflects more than comes in. GGX lobes are completed by what microfacets reflect between each other
// (albedo_tables.h).
#pragma once

#include "core/base/vec.h"
#include "core/shade/point2.h"

namespace msbvh {

// What a material makes of a place.
struct SurfaceLook {
  Vec3f diffuse;          // albedo of the diffuse part; 0 of a metal
  Vec3f f0, f90;          // reflectance at normal and at grazing incidence; both 0: no specular lobe
  float alpha = 1.0f;     // of the microfacets: roughness squared
  float coat = 0.0f;      // how much of a clear coat there is, in [0, 1]
  float coat_f0 = 0.04f;  // its reflectance at normal incidence
  float coat_alpha = 1e-3f;
  // Of its inside, for what is transparent: Bsdf does not look at them.
  float ior = 1.5f;
  float metal = 0.0f;  // how much of it lets no light in
};

// A direction that light takes, and what it carries.
struct BsdfSample {
  Vec3f direction;
  float pdf = 0.0f;  // per steradian; 0: none
  Vec3f weight;      // reflected over incoming radiance times cosine, over pdf
  Vec3f specular;    // of the weight, what specular lobes give
};

// Of one place, for light that leaves it in one direction. Directions are unit vectors in the world.
class Bsdf {
 public:
  Bsdf() = default;
  // `normal`: the shading normal, on the side of `out`. A direction below it counts as one just above.
  Bsdf(const SurfaceLook& look, const Vec3f& normal, const Vec3f& out);

  struct Value {
    Vec3f diffuse, specular;  // reflected over incoming radiance, times the cosine at the surface
    float pdf;                // that sample() takes that direction, per steradian
    Vec3f both() const { return diffuse + specular; }
  };
  // 0 for a direction below the shading normal's horizon.
  Value at(const Vec3f& normal, const Vec3f& in) const;
  // `lobe` in [0, 1) says which.
  BsdfSample sample(const Vec3f& normal, float lobe, Point2 random) const;

  // Of light from everywhere: what is reflected.
  const Vec3f& albedo() const { return albedo_; }

 private:
  Value at_local(const Vec3f& in) const;

  SurfaceLook look_;
  Vec3f out_;      // in the surface's space
  Vec3f diffuse_;  // by a cosine and what is let through on the way in: the diffuse part
  Vec3f between_;  // likewise: what microfacets reflect between each other
  Vec3f missing_;  // reflectance of light that microfacets reflect to each other
  Vec3f albedo_;
  float coat_passed_ = 1.0f;                           // what the coat lets through on the way out
  float coat_between_ = 0.0f;                          // as between_, of the coat
  float choose_coat_ = 0.0f, choose_specular_ = 0.0f;  // chances of the lobes, the rest is the cosine's
};

}  // namespace msbvh
