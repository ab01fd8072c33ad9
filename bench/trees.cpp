#include "bench/trees.h"

#include "core/base/parallel.h"

namespace msbvh::bench {
namespace {

void add_all(const std::shared_ptr<const Scene>& scene, const std::vector<GeometryId>& geometry,
             Accel& accel) {
  for (const GeometryId i : geometry) {
    switch (i.kind()) {
      case GeometryKind::kTriangleMesh:
        accel.add_mesh(std::shared_ptr<const TriangleMesh>(scene, &scene->mesh(i).shape));
        break;
      case GeometryKind::kGridMesh:
        accel.add_grids(std::shared_ptr<const GridMesh>(scene, &scene->grids[i.index()].shape));
        break;
      case GeometryKind::kCurves:
        accel.add_curves(std::shared_ptr<const CurveSet>(scene, &scene->curves[i.index()].shape));
        break;
      case GeometryKind::kPoints:
        accel.add_points(std::shared_ptr<const PointSet>(scene, &scene->points[i.index()].shape));
        break;
    }
  }
}

}  // namespace

Trees::Trees(const std::shared_ptr<const Scene>& scene, const BuildSettings& settings)
    : prototypes_(scene->prototypes.size()) {
  for (const InstanceSet& set : scene->instances) {
    if (instance_count(set) > 0 && !prototypes_[set.prototype])
      prototypes_[set.prototype] = std::make_shared<Accel>();
  }
  parallel_for(prototypes_.size(), [&](std::size_t i) {
    if (!prototypes_[i]) return;
    add_all(scene, scene->prototypes[i].geometry, *prototypes_[i]);
    prototypes_[i]->set_time_remap(scene->prototypes[i].time_remap);
    prototypes_[i]->commit(settings);
  });
  add_all(scene, scene->world, world_);
  for (const InstanceSet& set : scene->instances) {
    if (instance_count(set) == 0) continue;
    world_.add_instances(prototypes_[set.prototype], set.form(), set.world_from_prototype, set.time_remap);
  }
  world_.commit(settings);
  statistics_ = world_.statistics();
  for (const auto& prototype : prototypes_) {
    if (prototype) statistics_ += prototype->statistics();
  }
  // A ray sees the world's tree first: its cost and depth alone, which those of prototypes would hide.
  statistics_.sah_cost = world_.statistics().sah_cost;
  statistics_.depth = world_.statistics().depth;
}

Box3f Trees::bounds() const {
  Box3f box;
  for (const Box3f& at_control : world().root_bounds) box.grow(at_control);
  return box;
}

}  // namespace msbvh::bench
