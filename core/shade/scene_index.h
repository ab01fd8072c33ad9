// What the ids of a Hit stand for in the Scene.
//
// The world's tree holds the geometry of Scene::world and the instances of Scene::instances, set by set,
// and each prototype's tree that of Prototype::geometry, all in the scene's order: ids count along it, each
// kind apart.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/plan/effect_variant.h"
#include "core/scene/scene.h"
#include "core/trace/ray.h"

namespace msbvh {

// What was hit, and through which instance; `instances` is null for what stands in the world itself.
struct HitSource {
  const Appearance* look = nullptr;
  // The one of these that it is; the others are null.
  const Mesh* mesh = nullptr;
  const Grids* grids = nullptr;
  const Curves* curves = nullptr;
  const Points* points = nullptr;
  const InstanceSet* instances = nullptr;
  std::uint32_t instance = 0;            // index in the set
  const Prototype* prototype = nullptr;  // likewise null

  // The controls of the instance's transform: instances->form().controls().
  std::span<const Affine3f> instance_controls() const {
    const std::size_t controls = instances->form().controls();
    return {instances->world_from_prototype.data() + instance * controls, controls};
  }
  // The instance's, else that of what was hit: which lights illuminate it.
  std::uint32_t light_group() const {
    return instances && !instances->light_groups.empty() ? instances->light_groups[instance]
                                                         : look->light_group;
  }
  // The shutter's time in the time of the geometry's tracks, and in that of the instance's.
  template <EffectSet kEffects = kKnownEffects>
  float own_time(float time) const {
    if constexpr (!kEffects.has(Effect::kTimeRemaps)) return time;
    return prototype ? local(prototype->time_remap, time) : time;
  }
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
    first_of_kind_.push_back(first_of_kinds(scene.world));
    for (const Prototype& prototype : scene.prototypes)
      first_of_kind_.push_back(first_of_kinds(prototype.geometry));
  }

  const Scene& scene() const { return *scene_; }

  // kEffects: those that the scene may have; kPlain where it has none.
  template <EffectSet kEffects = kKnownEffects>
  HitSource resolve(const Hit& hit) const {
    HitSource source;
    if (!kEffects.has(Effect::kInstances) || hit.instance == kNoInstance) {
      set_geometry<kEffects>(scene_->world, 0, hit.geometry, source);
      return source;
    }
    const std::uint32_t set = set_of_instance_[hit.instance];
    source.instances = &scene_->instances[set];
    source.instance = hit.instance - first_instance_[set];
    source.prototype = &scene_->prototypes[source.instances->prototype];
    set_geometry<kEffects>(source.prototype->geometry, source.instances->prototype + 1, hit.geometry, source);
    return source;
  }

 private:
  static constexpr std::size_t kKinds = 4;
  using Firsts = std::array<std::uint32_t, kKinds>;  // by GeometryKind: where it begins in a list

  static Firsts first_of_kinds(const std::vector<GeometryId>& list) {
    Firsts firsts{};
    for (const GeometryId id : list) {
      for (std::size_t later = std::size_t(id.kind()) + 1; later < kKinds; ++later) ++firsts[later];
    }
    return firsts;
  }

  // `list_index`: in first_of_kind_.
  template <EffectSet kEffects>
  void set_geometry(const std::vector<GeometryId>& list, std::size_t list_index, GeometryId in_tree,
                    HitSource& source) const {
    constexpr bool kGrids = kEffects.has(Effect::kDisplacement), kCurves = kEffects.has(Effect::kCurves),
                   kPoints = kEffects.has(Effect::kPoints);
    if (!(kGrids || kCurves || kPoints) ||
        in_tree.is(GeometryKind::kTriangleMesh)) {  // the first kind, and nearly always the one
      source.look = source.mesh = &scene_->mesh(list[in_tree.index()]);
      return;
    }
    const GeometryId id = list[first_of_kind_[list_index][std::size_t(in_tree.kind())] + in_tree.index()];
    if (kGrids && id.is(GeometryKind::kGridMesh)) {
      source.look = source.grids = &scene_->grids[id.index()];
    } else if (kCurves && id.is(GeometryKind::kCurves)) {
      source.look = source.curves = &scene_->curves[id.index()];
    } else if (kPoints && id.is(GeometryKind::kPoints)) {
      source.look = source.points = &scene_->points[id.index()];
    }
  }

  const Scene* scene_;
  std::vector<std::uint32_t> set_of_instance_;
  std::vector<std::uint32_t> first_instance_;  // of each set
  std::vector<Firsts> first_of_kind_;          // of the world, then of each prototype
};

}  // namespace msbvh
