// Where rays start that leave a surface, so that they neither hit the surface they leave nor have slipped
// past another one: on the line of the ray that came, before its hit, clear of everything by more than the
// tracer errs. docs/design/watertight.md, section 4, has the proof.
#pragma once

#include "core/shade/clearance.h"
#include "core/shade/world_triangle.h"
#include "core/trace/ray.h"

namespace msbvh {

struct RayOrigin {
  Vec3f before;  // on the side that the ray came from
  // Next to an edge, or seen edge-on: `before` is not proved to be clear of what else is there.
  // clear_origin() must find a place that is.
  bool beside_edge = false;

  // World units.
  double need = 0.0;        // how far from the triangle an origin must be
  double view_error = 0.0;  // how far the ray may have passed from where it seems to have
  double way = 0.0;         // from the hit back to the ray's origin
  double cosine = 0.0;      // between that way and the normal
};

// Of the triangle that `ray` hit at `position`. `normal`: unit, on the ray's side. `doubled_area`: twice the
// triangle's.
RayOrigin origin_at(const WorldTriangle& triangle, const Hit& hit, const Ray& ray, const Vec3d& position,
                    const Vec3d& normal, double doubled_area);

// Moves origin.before to where it is clear of all surfaces, if it is beside an edge. False: no place was
// found, and nothing may leave the surface there. kEffects: kPlain or kKnownEffects.
template <EffectSet kEffects = kKnownEffects>
bool clear_origin(const Surroundings& around, const Ray& ray, RayOrigin& origin);

}  // namespace msbvh
