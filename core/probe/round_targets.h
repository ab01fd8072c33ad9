// The curves and points that a tree shows, its instances' among them, to aim at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/bvh/bvh.h"
#include "core/probe/probe_random.h"

namespace msbvh {

// A point of the world in the middle of a curve or a sphere. `along` is the direction that a curve runs in,
// zero where it runs nowhere and for spheres.
struct RoundTarget {
  Vec3d centre, along;
  double radius;  // of the largest of the map's columns where it is an instance's: at least the drawn one
};

class RoundTargets {
 public:
  // `world` must outlive it.
  explicit RoundTargets(const Bvh& world);

  bool empty() const { return sets_.empty(); }
  // Somewhere on the centre line of a random span, often at its ends; or a random point. None where it is not
  // there at this time. Not to be called when empty().
  std::optional<RoundTarget> pick(float time, ProbeRandom& random) const;

 private:
  struct Set {
    const CurveSet* curves;  // one of the two is null
    const PointSet* points;
    std::uint32_t instance;
  };
  void add(const Bvh& bvh, std::uint32_t instance);

  const Bvh& world_;
  std::vector<Set> sets_;
};

}  // namespace msbvh
