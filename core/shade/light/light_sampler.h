// Which lights a vertex of a path asks for light.
//
// Each of a few; of many, a few by chance, each as likely as half by what it gives and half all alike. A
// light's share of the samples is thus at least half of what it would be if all were alike, however wrong the
// guess of what it gives: no sample weighs more than twice as much as there.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/box.h"
#include "core/scene/scene.h"
#include "core/shade/light/light.h"

namespace msbvh {

// Lights that a vertex asks at most.
inline constexpr std::uint32_t kLightPicks = 4;

struct LightPick {
  const Light* light;
  const PlacedLight* still;  // null for one that moves or changes
  float expected;            // how many of a vertex's picks are this light, in the mean
  bool extended;             // has_extent()
};

// The scene's lights as an integrator wants them. Keeps pointers into the scene.
class LightSampler {
 public:
  // `bounds`: the world's, which says how far from lights surfaces are.
  LightSampler(const Scene& scene, const Box3f& bounds);
  LightSampler(LightSampler&&) = default;

  // At each vertex.
  std::uint32_t picks() const { return picks_; }
  // Number `which` of them; `random` in [0, 1), the same for all picks of a vertex. Does not read it where
  // each light is picked.
  LightPick pick(std::uint32_t which, float random) const;
  bool by_chance() const { return !cumulative_.empty(); }

  // The sum of all constant domes at a time; zero without.
  Vec3f dome_radiance(float time) const {
    return moving_domes_.empty() ? still_dome_radiance_ : moving_dome_radiance(time);
  }
  bool has_dome() const { return has_dome_; }
  // Of all domes with an image: what a ray to nowhere sees. They are among the picks.
  Vec3f image_domes_radiance(const Vec3f& direction, float time) const;
  // Whether a light has any that its shadow rays must ask for.
  bool has_shadow_settings() const { return has_shadow_settings_; }

 private:
  void weigh(const Box3f& bounds);
  Vec3f moving_dome_radiance(float time) const;

  std::vector<LightPick> lights_;  // all but constant domes
  std::vector<PlacedLight> placed_;
  std::vector<float> cumulative_;  // of their chances; empty where each is picked
  std::uint32_t picks_ = 0;
  bool has_dome_ = false;
  bool has_shadow_settings_ = false;
  Vec3f still_dome_radiance_;
  std::vector<const Light*> moving_domes_;
};

}  // namespace msbvh
