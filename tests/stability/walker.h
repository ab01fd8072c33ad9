// Paths that bounce about in a closed surface, and what becomes of them.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/base/parallel.h"
#include "core/bvh/bvh.h"
#include "core/shade/surface_hit.h"

namespace msbvh::shells {

inline constexpr int kBounces = 4;  // of a path
inline constexpr int kProbes = 4;   // shadow rays from each place where it bounces

struct Tally {
  std::uint64_t rays = 0, escaped = 0, bounces = 0, ended = 0;  // ended: no place to go on from
  std::uint64_t looked = 0;                                     // bounces whose neighbours were looked at

  Tally& operator+=(const Tally& b) {
    rays += b.rays;
    escaped += b.escaped;
    bounces += b.bounces;
    ended += b.ended;
    looked += b.looked;
    return *this;
  }
};

// `Trap`: a closed surface in a scene with its tree: scene(), index(), accel(), first_ray() from inside of
// it, towards_edge(): a direction to a place of it next to an edge or a corner.
template <class Trap>
class Walker {
 public:
  Walker(const Trap& trap, float aimed, std::uint64_t seed) : trap_(trap), aimed_(aimed), random_(seed) {}

  void walk() {
    Ray ray = trap_.first_ray(random_);
    if (random_.uniform() < aimed_) ray.dir = trap_.towards_edge(ray.org, ray.time, random_);
    Hit hit;
    for (int depth = 0; depth < kBounces && meets(ray, hit); ++depth) {
      SurfaceHit surface = surface_at(trap_.scene(), trap_.index().resolve(hit), hit, ray);
      ++tally_.bounces;
      tally_.looked += surface.origin.beside_edge;
      if (!clear_origin({trap_.index(), trap_.accel().bvh()}, ray, surface.origin)) {
        ++tally_.ended;
        return;
      }
      const float time = ray.time;
      for (int i = 0; i < kProbes; ++i) {
        ray = leaving(surface, time);
        ++tally_.rays;
        tally_.escaped += !trap_.accel().occluded(ray);
      }
    }
  }
  const Tally& tally() const { return tally_; }

 private:
  bool meets(const Ray& ray, Hit& hit) {
    ++tally_.rays;
    if (trap_.accel().intersect(ray, hit)) return true;
    ++tally_.escaped;
    return false;
  }

  Ray leaving(const SurfaceHit& surface, float time) {
    Vec3f direction = random_.direction();
    if (random_.uniform() < aimed_) direction = trap_.towards_edge(surface.position, time, random_);
    const float cosine = dot(direction, surface.geometric_normal);
    // To the upper side, by a mirror.
    if (cosine < 0.0f) direction += surface.geometric_normal * (-2.0f * cosine);
    if (dot(direction, surface.geometric_normal) < 0.0f) direction = surface.geometric_normal;
    return leave(surface, direction, time);
  }

  const Trap& trap_;
  const float aimed_;
  procedural::Random random_;
  Tally tally_;
};

inline constexpr std::uint64_t kPathsAtOnce = 512;

// `work(i)` is of kPathsAtOnce paths, with a seed of their own.
template <class Result, class Work>
Result in_parallel(std::uint64_t paths, const Work& work) {
  std::vector<Result> results((paths + kPathsAtOnce - 1) / kPathsAtOnce);
  parallel_for(results.size(), [&](std::size_t i) { results[i] = work(i); });
  Result sum;
  for (const Result& r : results) sum += r;
  return sum;
}

}  // namespace msbvh::shells
