// The value of a primvar where a ray has hit, whatever kind of geometry that is.
#pragma once

#include "core/shade/primvar.h"
#include "core/shade/scene_index.h"
#include "core/trace/ray.h"

namespace msbvh {

// `primvar` must be authored. kEffects: those that the scene may have; kPlain or kKnownEffects.
template <EffectSet kEffects = kKnownEffects, typename T>
T value_at(const Primvar<T>& primvar, const HitSource& source, const Hit& hit, float time) {
  if (kEffects.has(Effect::kCurves) && source.curves)
    return interpolate(primvar, source.curves->shape, hit.triangle, hit.u, time);
  if (kEffects.has(Effect::kPoints) && source.points)
    return interpolate(primvar, source.points->shape, hit.triangle, time);
  if (kEffects.has(Effect::kDisplacement) && source.grids) {
    const GridMesh& shape = source.grids->shape;
    return interpolate(primvar, shape, shape.triangle(hit.triangle), Barycentrics::of(hit.u, hit.v), time);
  }
  return interpolate(primvar, source.mesh->shape, hit.triangle, Barycentrics::of(hit.u, hit.v), time);
}

}  // namespace msbvh
