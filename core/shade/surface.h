// From a hit to what shading needs to know about the surface there.
#pragma once

#include "core/shade/scene_index.h"
#include "core/trace/ray.h"

namespace msbvh {

struct SurfacePoint {
  Vec3f position;          // in the world
  Vec3f self_hit_margin;   // by axis: how far the tracer may see the triangle from `position`, see
                           // offset_origin()
  Vec3f geometric_normal;  // unit; on the side that the ray came from, as is the shading normal
  Vec3f shading_normal;    // unit
  Vec3f albedo;
  Vec3f emission;  // radiance, from both sides
};

// The hit of `ray`, through the instance's transform at the ray's time.
SurfacePoint surface_at(const Scene& scene, const HitSource& source, const Hit& hit, const Ray& ray);

// In [0, 1].
float opacity_at(const Scene& scene, const HitSource& source, const Hit& hit, float time);

// An origin for rays that leave the surface in `direction`, as near to `position` as it can be so that they
// do not hit the triangle they start on: moved along the normal out of the slab that `self_hit_margin` spans.
// pbrt-v4, section 6.8.6, "Robust Spawned Ray Origins".
inline Vec3f offset_origin(const SurfacePoint& surface, const Vec3f& direction) {
  const Vec3f& n = surface.geometric_normal;
  const Vec3f offset = n * dot(abs(n), surface.self_hit_margin);
  return dot(direction, n) < 0.0f ? surface.position - offset : surface.position + offset;
}

}  // namespace msbvh
