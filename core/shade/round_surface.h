// The surface where a curve or a point was hit, colours apart.
#pragma once

#include "core/shade/scene_index.h"
#include "core/shade/surface_hit.h"

namespace msbvh {

// A ribbon that is turned to the ray is shaded as the tube that it stands for: its normal follows the tube's
// round, from edge to edge, and rays leave from the tube's surface, so that they do not meet the ribbon that
// is turned to them where they start.
SurfaceHit curve_surface(const HitSource& source, const Hit& hit, const Ray& ray);

// Of a curve where it was hit, in the world, towards its end; any length.
Vec3f curve_tangent(const HitSource& source, const Hit& hit, const Ray& ray);

SurfaceHit point_surface(const HitSource& source, const Hit& hit, const Ray& ray);

}  // namespace msbvh
