// Which lights a vertex of a path asks for light.
//
// Each of a few; of many, a few by chance: three quarters by what each gives to the surface there, about, one
// quarter all alike. A light's share of the samples is thus at least a quarter of what it would be if all
// were alike, however wrong the guess: no sample weighs more than four times as much as there.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/box.h"
#include "core/scene/scene.h"
#include "core/shade/light/light.h"
#include "core/shade/light/light_tree.h"
#include "core/shade/light/light_visibility.h"
#include "core/shade/light/mesh_light.h"

namespace msbvh {

// Lights that a vertex asks at most.
inline constexpr std::uint32_t kLightPicks = 4;
// From so many lights with a place on it is learnt which are seen from where.
inline constexpr std::size_t kLearnFrom = 32;
// The share of the picks that know nothing of what lights give.
inline constexpr float kAlikeShare = 0.25f;

struct LightPick {
  const Light* light;
  const PlacedLight* still;         // null for one that moves or changes
  float expected;                   // how many of the vertex's picks are this light, in the mean
  bool extended;                    // has_extent(): a scattered ray asks whether it meets it
  const MeshLight* mesh = nullptr;  // null for one that is no mesh
};

// The scene's lights as an integrator wants them. Keeps pointers into the scene.
class LightSampler {
 public:
  // `bounds`: the world's, which says how far from lights surfaces are.
  LightSampler(const Scene& scene, const Box3f& bounds);
  LightSampler(LightSampler&&) = default;

  // At each vertex.
  std::uint32_t picks() const { return picks_; }
  // Number `which` of them; `random` in [0, 1), the same for all picks of a vertex, which is at `point` of a
  // surface with the unit `normal`.
  LightPick pick(std::uint32_t which, float random, const Vec3f& point, const Vec3f& normal) const;
  // The same where each light is picked.
  const LightPick& pick(std::uint32_t which) const { return lights_[which]; }
  bool by_chance() const { return lights_.size() > kLightPicks; }

  // How many have a place, where lights are picked by chance. From kLearnFrom on learning is worth its rays.
  std::size_t placed_count() const { return placed_lights_.size(); }
  // One of those with a place, as the tree has it; a pick of null: none reaches the surface.
  struct Tried {
    const LightPick* pick = nullptr;
    std::uint32_t light = 0;  // number in the tree
  };
  Tried try_light(float random, const Vec3f& point, const Vec3f& normal) const;
  void learn(const std::vector<SeenLight>& rays) { visibility_ = LightVisibility(bounds_, tree_, rays); }

  // Meshes that shine: rays that go on from a surface meet them as they meet any surface.
  bool has_meshes() const { return !meshes_.empty(); }
  // The one that was hit, or null. The pick's `expected` is that of a vertex where each light is picked.
  const LightPick* mesh_at(const HitSource& source) const;
  // How many of a vertex's picks are that light, in the mean.
  float expected(const LightPick& light, const Vec3f& point, const Vec3f& normal) const;

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
  float importance(const Vec3f& point, const Vec3f& normal) const;
  // That a pick is a light, at a vertex where the tree has some importance.
  float chance(std::uint32_t light, float importance, const Vec3f& point, const Vec3f& normal) const;
  std::uint32_t found(float random, float importance, const Vec3f& point, const Vec3f& normal) const;
  Vec3f moving_dome_radiance(float time) const;
  void add_mesh(const Light& light);
  void sort_meshes();

  const Scene* scene_;
  std::vector<LightPick> lights_;  // all but constant domes
  std::vector<PlacedLight> placed_;
  // Where they are picked by chance: those with a place are in the tree, the rest has the same importance
  // everywhere.
  LightTree tree_;
  LightVisibility visibility_;
  Box3f bounds_;
  std::vector<std::uint32_t> placed_lights_;      // by their number in the tree
  std::vector<std::uint32_t> distant_lights_;     // in the order of the following
  std::vector<float> cumulative_;                 // of the importance of these
  std::vector<std::uint32_t> place_in_its_list_;  // by light: in one of the lists above
  std::uint32_t picks_ = 0;
  bool has_dome_ = false;
  bool has_shadow_settings_ = false;
  Vec3f still_dome_radiance_;
  std::vector<const Light*> moving_domes_;
  std::vector<std::unique_ptr<MeshLight>> meshes_;
  std::vector<std::shared_ptr<const TriangleShares>> shares_;  // by mesh; null where it does not shine
  std::vector<std::uint32_t> by_surface_;  // those of lights_ that are meshes, by mesh, set and instance
};

}  // namespace msbvh
