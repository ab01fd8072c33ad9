// From a hit to what shading needs to know about the surface there.
#pragma once

#include "core/shade/ray_origin.h"
#include "core/shade/scene_index.h"
#include "core/trace/ray.h"

namespace msbvh {

struct SurfaceHit {
  Vec3f position;          // in the world
  Vec3f geometric_normal;  // unit; on the side that the ray came from, as is the shading normal
  Vec3f shading_normal;    // unit
  Vec3f albedo;
  Vec3f emission;    // radiance, from both sides
  RayOrigin origin;  // of rays that leave; see clear_origin()
};

// The hit of `ray`, through the instance's transform at the ray's time. kEffects: those that the scene may
// have; kPlain or kKnownEffects.
template <EffectSet kEffects = kKnownEffects>
SurfaceHit surface_at(const Scene& scene, const HitSource& source, const Hit& hit, const Ray& ray);

// A ray from the surface in `direction`, on either side of it; clear_origin() comes first. To the far side
// it starts clear of the triangle that was hit, and no more is proved. Hits count from tnear = 0 on.
inline Ray leave(const SurfaceHit& surface, const Vec3f& direction, float time) {
  Ray ray;
  const Vec3f& n = surface.geometric_normal;
  // Twice, for the roundings of the position and of this.
  const float beyond = 2.0f * static_cast<float>(surface.origin.need);
  ray.org = dot(direction, n) < 0.0f ? surface.position - n * beyond : surface.origin.before;
  ray.dir = direction;
  ray.time = time;
  return ray;
}

// In Scene::materials, or kNone: the instance's, else that of what was hit.
template <EffectSet kEffects = kKnownEffects>
std::uint32_t material_index(const HitSource& source, const Hit& hit);

// In [0, 1].
float opacity_at(const Scene& scene, const HitSource& source, const Hit& hit, float time);

}  // namespace msbvh
