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
      bounds[i] = bound_instance({bvh.keys_of(instance), key_count(instance.segments)}, instance.segments,
                                 instance.object->root_bounds, instance.object->root_segments);
    }
  });
  return bounds;
}

bool is_moving(const Bvh& bvh) {
  return bvh.max_level > 0 || std::any_of(bvh.instances.begin(), bvh.instances.end(), [](const Instance& i) {
           return i.segments > 0 || i.object->moving;
         });
}

}  // namespace

Bvh build_bvh(BvhInput input, const BuildSettings& settings) {
  const Stopwatch total;
  Bvh bvh;
  bvh.meshes = std::move(input.meshes);
  bvh.instances = std::move(input.instances);
  bvh.instance_keys = std::move(input.instance_keys);
  const std::vector<InstanceBounds> instance_bounds = bound_instances(bvh);
  const Primitives primitives{bvh.meshes, instance_bounds};

  const Stopwatch topology_watch;
  Topology topology = build_topology(primitives, settings);
  bvh.statistics.topology_seconds = topology_watch.seconds();
  const Stopwatch bounds_watch;
  flatten(primitives, topology, settings, bvh);
  bvh.statistics.bounds_seconds = bounds_watch.seconds();

  bvh.instanced = !bvh.instances.empty();
  bvh.moving = is_moving(bvh);
  for (const auto& mesh : bvh.meshes) bvh.statistics.triangles += mesh->triangles.size();
  bvh.statistics.instances = bvh.instances.size();
  bvh.statistics.references = topology.reference_count;
  bvh.statistics.build_seconds = total.seconds();
  return bvh;
}

}  // namespace msbvh
