#include "core/shade/ray_origin.h"

#include <algorithm>
#include <cmath>

namespace msbvh {
namespace {

// docs/design/watertight.md, section 4, derives these.
//
// How far from where it is the tracer may see a point, relative to its distance from the ray's origin: 5
// roundings of 2^-24 of the triangle test, and 1 each for the ray's origin and direction in an instance's
// space.
constexpr double kViewError = 7 * 0x1p-24;
// How far from an edge a hit is taken to be clear of the neighbour there, in what the triangle needs: it is
// if they meet at 10 degrees or more. Doubling it doubles how often neighbours are looked at.
constexpr double kSharpest = 8.0;
// Heights of a triangle in view errors from which on a ray sees faces at about the angles that they have.
constexpr double kWellSeen = 64.0;
// Cosine below which a ray sees a triangle edge-on: the way back to a height grows with its inverse.
constexpr double kEdgeOn = 1.0 / 64;
// The share of a ray's way that an origin goes back on it without a look at its neighbours.
constexpr double kShortStep = 0.25;
// How far around an origin to look for neighbours, in what the triangle that was hit needs. Larger triangles
// need more, and are found when they come so near.
constexpr double kReach = 4.0;
// The longest way back, likewise. Where it takes more, faces all but touch, or the ray all but runs in one.
constexpr double kLongestWay = 16384.0;

// Whether the hit is at least so far from the edges, in a triangle of at least such a height. A height is
// twice the area by the edge that it stands on.
bool well_inside(const WorldTriangle& t, const Hit& hit, double doubled_area, double from_edges,
                 double height) {
  const Vec3d a = t.vertex[1] - t.vertex[0], b = t.vertex[2] - t.vertex[0], c = t.vertex[2] - t.vertex[1];
  const double least = std::min({hit.u, hit.v, 1.0f - hit.u - hit.v});
  const double longest2 = std::max({dot(a, a), dot(b, b), dot(c, c)});
  const double needed = std::max(from_edges, height * least), found = doubled_area * least;
  return found > 0.0 && found * found > needed * needed * longest2;
}

}  // namespace

RayOrigin origin_at(const WorldTriangle& triangle, const Hit& hit, const Ray& ray, const Vec3d& position,
                    const Vec3d& normal, double doubled_area) {
  RayOrigin o;
  const Vec3d from(ray.org), back = -normalize(Vec3d(ray.dir));
  o.need = triangle.margin;
  o.way = dot(from - position, back);
  o.view_error = kViewError * o.way;
  o.cosine = dot(normal, back);
  const double step = o.need / std::max(o.cosine, kEdgeOn);
  o.before = Vec3f(position + back * step);
  o.beside_edge = o.cosine < kEdgeOn || step > kShortStep * o.way ||
                  !well_inside(triangle, hit, doubled_area, std::max(kSharpest * o.need, step + o.need),
                               kWellSeen * o.view_error);
  return o;
}

template <EffectSet kEffects>
bool clear_origin(const Surroundings& around, const Ray& ray, RayOrigin& o) {
  if (!o.beside_edge) return true;
  const double needed = o.need + o.view_error, longest = kLongestWay * needed;
  const Vec3d from(ray.org), along = normalize(Vec3d(ray.dir));
  double reach = kReach * needed;
  for (double step = needed / o.cosine; step < std::min(o.way, longest);) {
    const Vec3f place(from + along * (o.way - step));
    const Clearance clearance = clearance_at<kEffects>(around, place, ray.time, o.view_error, reach);
    if (clearance.clear) {
      o.before = place;
      return true;
    }
    reach = std::max(reach, 1.25 * clearance.needed);
    step = std::max(2.0 * step, clearance.needed);
  }
  // A ray that has come no further than that may start again where it started.
  o.before = ray.org;
  return o.way <= longest;
}

template bool clear_origin<kPlain>(const Surroundings&, const Ray&, RayOrigin&);
template bool clear_origin<kKnownEffects>(const Surroundings&, const Ray&, RayOrigin&);

}  // namespace msbvh
