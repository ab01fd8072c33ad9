// How much of a scene's geometry each effect holds in memory: counted, not estimated, before anything is
// built.
//
// Each byte of positions, indices and transforms belongs to one effect, or to none (the still triangles that
// a scene without effects would consist of), so that shares add up to 1. Of a track, the first key belongs to
// the effect that brings the shape (none for a mesh, subdivision, displacement, curves, points, instances),
// the other keys to the one that moves it (deforming keys, moving instances), and the controls between keys
// to polynomial motion. Effects of cameras, lights and settings hold no geometry: 0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/plan/effect_plan.h"
#include "core/scene/scene.h"

namespace msbvh {

struct EffectBytes {
  std::uint64_t base = 0;                               // of no effect
  std::array<std::uint64_t, kEffectCount> of_effect{};  // [index of the effect's bit]

  std::uint64_t& operator[](Effect effect);
  std::uint64_t operator[](Effect effect) const;
  std::uint64_t total() const;
};

// Of all geometry in the scene's lists: what no instance shows is held as well.
EffectBytes effect_bytes(const Scene& scene);

}  // namespace msbvh
