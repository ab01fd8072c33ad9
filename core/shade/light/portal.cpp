#include "core/shade/light/portal.h"

#include <algorithm>
#include <cmath>

#include "core/motion/affine_track.h"
#include "core/shade/light/flat.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// A portal at the dome's time.
struct PlacedPortal {
  Vec3f middle, x, y;  // its edges
  Vec3f area;          // along its +z, where the dome is, as long as its area

  PlacedPortal(const LightPortal& portal, float time) {
    const Affine3f m = evaluate(portal.world_from_portal, portal.segments, time);
    middle = m.t;
    x = m.x * portal.width;
    y = m.y * portal.height;
    area = cross(x, y);
    if (dot(area, m.z) < 0.0f) area = -area;  // a mirroring transform
  }

  // About the solid angle that it is seen under; 0 from where the dome is.
  float weight(const Vec3f& point) const {
    const Vec3f to_middle = middle - point;
    const float facing = dot(to_middle, area), distance_squared = dot(to_middle, to_middle);
    if (!(facing > 0.0f)) return 0.0f;
    const float seen = facing / (distance_squared * std::sqrt(distance_squared));
    return seen < 2.0f * kPi ? seen : 2.0f * kPi;  // infinity too
  }
};

float sum_of_weights(const PlacedLight& dome, const Vec3f& point) {
  float sum = 0.0f;
  for (const LightPortal& portal : dome.source->portals) sum += PlacedPortal(portal, dome.time).weight(point);
  return sum;
}

}  // namespace

bool any_portal(const PlacedLight& dome, const Vec3f& point) { return sum_of_weights(dome, point) > 0.0f; }

bool sample_portal(const PlacedLight& dome, const Vec3f& point, Point2 random, Vec3f& direction) {
  const float sum = sum_of_weights(dome, point);
  if (!(sum > 0.0f)) return false;
  float left = random.x * sum;
  for (const LightPortal& each : dome.source->portals) {
    const PlacedPortal portal(each, dome.time);
    const float weight = portal.weight(point);
    if (weight > 0.0f && left < weight) {
      const Vec3f place = portal.middle + portal.x * (left / weight - 0.5f) + portal.y * (random.y - 0.5f);
      direction = normalize(place - point);
      return true;
    }
    left -= weight;
  }
  return false;
}

float portal_pdf(const PlacedLight& dome, const Vec3f& point, const Vec3f& direction) {
  float density = 0.0f, sum = 0.0f;
  for (const LightPortal& each : dome.source->portals) {
    const PlacedPortal portal(each, dome.time);
    const float weight = portal.weight(point);
    sum += weight;
    FlatPlace place;
    if (!(weight > 0.0f) ||
        !find_flat(portal.middle, portal.x, portal.y, portal.area, point, direction, place))
      continue;
    const float half = 0.5f * place.scale;
    if (std::abs(place.u) <= half && std::abs(place.v) <= half) density += weight * place.pdf;
  }
  return sum > 0.0f ? density / sum : 0.0f;
}

}  // namespace msbvh
