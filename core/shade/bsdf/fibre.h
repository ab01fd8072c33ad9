// Light that a hair scatters: what it reflects, what goes through it, and what is reflected inside of it.
//
// M. Chiang, B. Bitterli, C. Tappan, B. Burley, "A Practical and Controllable Hair and Fur Model for
// Production Path Tracing", EGSR 2016. Lobes R, TT and TRT by themselves, what is reflected more often
// together. A hair that absorbs nothing gives back all light.
#pragma once

#include <array>

#include "core/shade/bsdf/bsdf.h"

namespace msbvh {

struct FibreLook {
  Vec3f absorption;                  // along a way as long as the radius
  float along = 0.3f, round = 0.3f;  // roughnesses in [0, 1]: along the hair, and round it
  float ior = 1.55f;
  float tilt_degrees = 2.0f;  // of its scales, towards its root
};

// By the paper's fit: what a thick coat of such hair looks like, from colours in [0, 1].
Vec3f fibre_absorption(const Vec3f& color, float round);

// As Bsdf is, for light from everywhere.
class Fibre {
 public:
  Fibre() = default;
  // `tangent`: towards the tip, any length. `normal`: of the round hair where it was hit, which says how far
  // from its middle that was.
  Fibre(const FibreLook& look, const Vec3f& tangent, const Vec3f& normal, const Vec3f& out);

  // All of it is `specular`; a cosine counts already, there is no side.
  Bsdf::Value at(const Vec3f& in) const;
  BsdfSample sample(float lobe, Point2 random) const;

  // Of light from everywhere.
  const Vec3f& albedo() const { return albedo_; }

  static constexpr std::size_t kLobes = 4;  // R, TT, TRT, and all others

 private:
  void set_widths(const FibreLook& look, float sine, float cosine);
  Bsdf::Value at_angles(float sine, float cosine, float phi) const;

  Vec3f x_{1.0f, 0.0f, 0.0f}, y_{0.0f, 1.0f, 0.0f}, z_{0.0f, 0.0f, 1.0f};  // along; towards who looks
  std::array<Vec3f, kLobes> share_{};                                      // of the light, by lobe
  std::array<float, kLobes> chance_{};                                     // of being sampled
  std::array<float, kLobes> sine_{}, cosine_{}, spread_{};  // of who looks, tilted; variances along
  std::array<float, kLobes> turn_{};                        // the lobes' middles round the hair
  float scale_ = 1.0f;                                      // of the logistic distribution round it
  Vec3f albedo_;
};

}  // namespace msbvh
