// Our side: the trees of a scene, as the renderer builds them.
#pragma once

#include <memory>
#include <vector>

#include "core/api/accel.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "core/scene/scene.h"

namespace msbvh::bench {

class Trees {
 public:
  // Uses the threads of the calling arena.
  Trees(const std::shared_ptr<const Scene>& scene, const BuildSettings& settings);

  const Bvh& world() const { return world_.bvh(); }
  // Sums over the trees; the SAH cost and the depth are the world's.
  const BvhStatistics& statistics() const { return statistics_; }
  std::uint64_t bytes() const { return statistics_.total_bytes(); }
  // Of everything at any time.
  Box3f bounds() const;

 private:
  std::vector<std::shared_ptr<Accel>> prototypes_;  // null where there are no instances
  Accel world_;
  BvhStatistics statistics_;
};

}  // namespace msbvh::bench
