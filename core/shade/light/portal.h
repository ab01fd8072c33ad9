// Portals of a dome: where to look for its light. They change no more than the noise.
#pragma once

#include "core/shade/light/light.h"

namespace msbvh {

// Places on the portals that a point is on the lit side of are sampled by area; portals by about the solid
// angle that they are seen under. A sample comes with another way to sample the dome, half each.
inline constexpr float kPortalShare = 0.5f;

// A direction through one of them; false where the point is on the lit side of none, or by a rounding.
bool sample_portal(const PlacedLight& dome, const Vec3f& point, Point2 random, Vec3f& direction);
// Its density, per steradian, where sample_portal() has one: any_portal() says.
float portal_pdf(const PlacedLight& dome, const Vec3f& point, const Vec3f& direction);
bool any_portal(const PlacedLight& dome, const Vec3f& point);

}  // namespace msbvh
