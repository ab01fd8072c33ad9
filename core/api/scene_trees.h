// The trees of a scene, and how those of the next frame come from them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/api/accel.h"
#include "core/bvh/statistics.h"
#include "core/scene/scene.h"

namespace msbvh {

// One tree a prototype that has instances, and the world's, with meshes and instances in the order that
// SceneIndex counts on. Trees keep the scene alive.
class SceneTrees {
 public:
  // Uses the threads of the calling arena. `previous`: the trees of the frame before, null for none; a
  // prototype takes over from the one of its name. Throws Cancelled.
  SceneTrees(const std::shared_ptr<const Scene>& scene, const BuildSettings& settings, SceneTrees* previous);

  const Accel& world() const { return world_; }
  void add_to(BvhStatistics& sum, std::uint64_t& trees) const;
  void verify() const;

 private:
  void build_prototypes(const Scene& scene, const BuildSettings& settings, SceneTrees* previous);
  void build_world(const Scene& scene, const BuildSettings& settings, SceneTrees* previous);

  std::shared_ptr<const Scene> scene_;
  std::vector<std::shared_ptr<Accel>> prototypes_;  // null where there are no instances
  Accel world_;
};

}  // namespace msbvh
