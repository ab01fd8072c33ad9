// Where on a texture something was hit, how large a ray's footprint is there, and which way its axes run.
#pragma once

#include <optional>

#include "core/scene/material.h"
#include "core/shade/scene_index.h"
#include "core/shade/surface_hit.h"
#include "core/texture/texture_cache.h"
#include "core/trace/ray.h"

namespace msbvh {

// About how wide a ray stands for: a cone. T. Akenine-Moller et al., "Texture Level of Detail Strategies for
// Real-Time Ray Tracing", Ray Tracing Gems, 2019.
struct RayCone {
  float width = 0.0f;   // world units, where the ray starts
  float spread = 0.0f;  // by which it grows along a unit of the ray

  float width_at(float distance) const { return width + spread * distance; }
};

// Texture coordinates at a hit, and how they change along the surface.
struct TexturePlace {
  float s = 0.0f, t = 0.0f;
  Vec3f s_gradient, t_gradient;  // a unit of the world, in the triangle's plane; 0 where they do not change
};

// `name`: of a primvar of two numbers. None where what was hit has no such primvar.
std::optional<TexturePlace> texture_place(const HitSource& source, const Hit& hit, const Ray& ray,
                                          PrimvarName name);

// `place` may be none: the read's fallback. `width`: of the ray's cone at the hit.
TextureQuery texture_query(const TextureRead& read, const std::optional<TexturePlace>& place,
                           const Vec3f& geometric_normal, const Vec3f& direction, float width);

// A normal in tangent space, whose x is along s and whose y along t, in the world: unit, on the side of
// `shading_normal`. That one where the coordinates do not change, or the normal has no length.
Vec3f bent_normal(const Vec3f& in_tangent_space, const Vec3f& shading_normal, const TexturePlace& place);

}  // namespace msbvh
