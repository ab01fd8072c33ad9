#include "core/api/scene_trees.h"

#include <string_view>
#include <unordered_map>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace msbvh {
namespace {

// Trees read the scene's own positions, and keep the scene alive for it. It has passed validate().
void share_geometry(const std::shared_ptr<const Scene>& scene, const std::vector<GeometryId>& geometry,
                    Accel& accel) {
  for (const GeometryId id : geometry) {
    if (id.is(GeometryKind::kTriangleMesh)) {
      accel.add_mesh(std::shared_ptr<const TriangleMesh>(scene, &scene->mesh(id).shape));
    } else if (id.is(GeometryKind::kGridMesh)) {
      accel.add_grids(std::shared_ptr<const GridMesh>(scene, &scene->grids[id.index()].shape));
    } else if (id.is(GeometryKind::kCurves)) {
      accel.add_curves(std::shared_ptr<const CurveSet>(scene, &scene->curves[id.index()].shape));
    } else {
      accel.add_points(std::shared_ptr<const PointSet>(scene, &scene->points[id.index()].shape));
    }
  }
}

// The builder asks only now and then, which for thousands of small trees is never.
void stop_if_cancelled(const BuildSettings& settings) {
  if (settings.cancelled && settings.cancelled()) throw Cancelled();
}

void commit(Accel& accel, Accel* previous, const BuildSettings& settings) {
  previous ? accel.commit_from(*previous, settings) : accel.commit(settings);
}

// For each prototype of `now` the index in `before` of the one with its name, kNone for none. Prototypes that
// share a name go by their order.
std::vector<std::uint32_t> same_prototypes(const Scene& now, const Scene& before) {
  std::unordered_map<std::string_view, std::vector<std::uint32_t>> named;
  for (std::size_t i = before.prototypes.size(); i-- > 0;) {
    named[before.prototypes[i].name].push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> same(now.prototypes.size(), kNone);
  for (std::size_t i = 0; i < same.size(); ++i) {
    const auto found = named.find(now.prototypes[i].name);
    if (found == named.end() || found->second.empty()) continue;
    same[i] = found->second.back();
    found->second.pop_back();
  }
  return same;
}

}  // namespace

SceneTrees::SceneTrees(const std::shared_ptr<const Scene>& scene, const BuildSettings& settings,
                       SceneTrees* previous)
    : scene_(scene), prototypes_(scene->prototypes.size()) {
  build_prototypes(*scene, settings, previous);
  build_world(*scene, settings, previous);
}

void SceneTrees::build_prototypes(const Scene& scene, const BuildSettings& settings, SceneTrees* previous) {
  for (const InstanceSet& set : scene.instances) {
    if (instance_count(set) > 0 && !prototypes_[set.prototype])
      prototypes_[set.prototype] = std::make_shared<Accel>();
  }
  const std::vector<std::uint32_t> same = previous ? same_prototypes(scene, *previous->scene_)
                                                   : std::vector<std::uint32_t>(prototypes_.size(), kNone);
  parallel_for(prototypes_.size(), [&](std::size_t i) {
    if (!prototypes_[i]) return;
    stop_if_cancelled(settings);
    share_geometry(scene_, scene.prototypes[i].geometry, *prototypes_[i]);
    prototypes_[i]->set_time_remap(scene.prototypes[i].time_remap);
    commit(*prototypes_[i], same[i] == kNone ? nullptr : previous->prototypes_[same[i]].get(), settings);
  });
}

void SceneTrees::build_world(const Scene& scene, const BuildSettings& settings, SceneTrees* previous) {
  stop_if_cancelled(settings);
  share_geometry(scene_, scene.world, world_);
  for (const InstanceSet& set : scene.instances) {
    if (instance_count(set) == 0) continue;
    world_.add_instances(prototypes_[set.prototype], set.form(), set.world_from_prototype, set.time_remap);
  }
  commit(world_, previous ? &previous->world_ : nullptr, settings);
}

void SceneTrees::add_to(BvhStatistics& sum, std::uint64_t& trees) const {
  for (const std::shared_ptr<Accel>& prototype : prototypes_) {
    if (!prototype) continue;
    sum += prototype->statistics();
    ++trees;
  }
  sum += world_.statistics();
  ++trees;
}

void SceneTrees::verify() const {
  for (const std::shared_ptr<Accel>& prototype : prototypes_) {
    if (prototype) prototype->verify();
  }
  world_.verify();
}

}  // namespace msbvh
