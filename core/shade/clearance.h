// How far a place is from every surface around it.
#pragma once

#include "core/bvh/bvh.h"
#include "core/shade/scene_index.h"

namespace msbvh {

// The geometry that origins must keep away from: a scene and the tree of its world.
struct Surroundings {
  const SceneIndex& index;
  const Bvh& world;
};

struct Clearance {
  bool clear = true;    // of each triangle by more than it needs
  double needed = 0.0;  // the most that a triangle in reach needs
};

// Looks at the triangles within `reach` of the place at a time of the shutter. Each needs its
// WorldTriangle::margin and `view_error`, in world units. kEffects: kPlain or kKnownEffects.
template <EffectSet kEffects = kKnownEffects>
Clearance clearance_at(const Surroundings& around, const Vec3f& place, float time, double view_error,
                       double reach);

}  // namespace msbvh
