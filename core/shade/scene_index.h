// What the ids of a Hit stand for in the Scene.
//
// The world's tree holds the meshes of Scene::world and the instances of Scene::instances, set by set,
// and each prototype's tree the meshes of Prototype::meshes, all in the scene's order: ids count along it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace msbvh {

// The mesh that was hit, and through which instance; `instances` is null for a mesh that stands in the world
// itself.
struct HitSource {
  const Mesh* mesh = nullptr;
  const InstanceSet* instances = nullptr;
  std::uint32_t instance = 0;            // index in the set
  const Prototype* prototype = nullptr;  // likewise null

  // The controls of the instance's transform: instances->form().controls().
  std::span<const Affine3f> instance_controls() const {
    const std::size_t controls = instances->form().controls();
    return {instances->world_from_prototype.data() + instance * controls, controls};
  }
  // The shutter's time in the time of the mesh's tracks, and in that of the instance's.
  float mesh_time(float time) const { return prototype ? local(prototype->time_remap, time) : time; }
  float instance_time(float time) const { return local(instances->time_remap, time); }

 private:
  static float local(const TimeRemap& time_remap, float time) {
    time_remap.at(time, time);
    return time;
  }
};

class SceneIndex {
 public:
  explicit SceneIndex(const Scene& scene) : scene_(&scene) {
    for (std::uint32_t set = 0; set < scene.instances.size(); ++set) {
      first_instance_.push_back(static_cast<std::uint32_t>(set_of_instance_.size()));
      set_of_instance_.insert(set_of_instance_.end(), instance_count(scene.instances[set]), set);
    }
  }

  const Scene& scene() const { return *scene_; }

  HitSource resolve(const Hit& hit) const {
    if (hit.instance == kNoInstance) return {.mesh = &scene_->mesh(scene_->world[hit.geometry.index()])};
    const std::uint32_t set = set_of_instance_[hit.instance];
    const InstanceSet& instances = scene_->instances[set];
    const Prototype& prototype = scene_->prototypes[instances.prototype];
    return {.mesh = &scene_->mesh(prototype.geometry[hit.geometry.index()]),
            .instances = &instances,
            .instance = hit.instance - first_instance_[set],
            .prototype = &prototype};
  }

 private:
  const Scene* scene_;
  std::vector<std::uint32_t> set_of_instance_;
  std::vector<std::uint32_t> first_instance_;  // of each set
};

}  // namespace msbvh
