#include "core/bvh/build_bvh.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/build/topology.h"
#include "core/bvh/flatten.h"
#include "core/bvh/instance_bounds.h"

namespace msbvh {
namespace {

constexpr std::size_t kInstancesPerTask = 1024;

std::vector<InstanceBounds> bound_instances(const Bvh& bvh) {
  std::vector<InstanceBounds> bounds(bvh.instances.size());
  parallel_for_ranges(bounds.size(), kInstancesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Instance& instance = bvh.instances[i];
      bounds[i] = instance_bounds_of(bvh, instance);
    }
  });
  return bounds;
}

Movement movement_of(const TrackForm& form) {
  if (!form.moving()) return Movement::kStill;
  return form.degree == 1 ? Movement::kLinear : Movement::kPolynomial;
}

// An instance that is there for a part of the shutter moves, in that a ray's time matters.
Movement movement_of(const Bvh& bvh) {
  Movement most = movement_of(bvh.root_form);
  for (const auto& mesh : bvh.meshes) most = std::max(most, movement_of(mesh->form()));
  for (const auto& mesh : bvh.grids) most = std::max(most, movement_of(mesh->form()));
  for (const Instance& i : bvh.instances) {
    most = std::max({most, movement_of(i.form), i.object->movement});
    const bool clocked = i.clock != kNoClock || !i.object->clock.is_shutter();
    if (clocked) most = std::max(most, Movement::kLinear);
  }
  return most;
}

}  // namespace

InstanceBounds instance_bounds_of(const Bvh& bvh, const Instance& instance) {
  const Bvh& object = *instance.object;
  return bound_instance(
      {{bvh.controls_of(instance), instance.form.controls()}, instance.form, bvh.clock_of(instance)},
      {object.root_bounds, object.root_form, &object.clock});
}

Bvh build_bvh(BvhInput input, const BuildSettings& settings) {
  const Stopwatch total;
  Bvh bvh;
  bvh.meshes = std::move(input.meshes);
  bvh.grids = std::move(input.grids);
  bvh.instances = std::move(input.instances);
  bvh.instance_controls = std::move(input.instance_controls);
  bvh.clocks = std::move(input.clocks);
  bvh.clock = std::move(input.clock);
  const std::vector<InstanceBounds> instance_bounds = bound_instances(bvh);
  const Primitives primitives{bvh.meshes, instance_bounds, bvh.grids};

  const Stopwatch topology_watch;
  Topology topology = build_topology(primitives, settings);
  bvh.statistics.topology_seconds = topology_watch.seconds();
  const Stopwatch bounds_watch;
  flatten(primitives, topology, settings, bvh);
  bvh.statistics.bounds_seconds = bounds_watch.seconds();

  bvh.instanced = !bvh.instances.empty();
  bvh.gridded = !bvh.grids.empty() ||
                std::ranges::any_of(bvh.instances, [](const Instance& i) { return i.object->gridded; });
  bvh.movement = movement_of(bvh);
  for (const auto& mesh : bvh.meshes) bvh.statistics.triangles += mesh->triangles.size();
  for (const auto& mesh : bvh.grids) {
    bvh.statistics.patches += mesh->patches.size();
    bvh.statistics.quads += mesh->quad_count;
    bvh.statistics.grid_bytes += mesh->values.size() * sizeof(float);
  }
  bvh.statistics.instances = bvh.instances.size();
  bvh.statistics.references = topology.reference_count;
  bvh.statistics.build_seconds = total.seconds();
  return bvh;
}

}  // namespace msbvh
