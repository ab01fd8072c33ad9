#include "core/bvh/build_bvh.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/build/topology.h"
#include "core/bvh/flatten.h"
#include "core/bvh/instance_bounds.h"
#include "core/bvh/refit.h"
#include "core/bvh/time_split.h"

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
  Movement most = movement_of(bvh.root_form);  // still where the tree is swept
  for (const auto& mesh : bvh.meshes) most = std::max(most, movement_of(mesh->form()));
  for (const Instance& i : bvh.instances) {
    most = std::max({most, movement_of(i.form), i.object->movement});
    const bool clocked = i.clock != kNoClock || !i.object->clock.is_shutter();
    if (clocked) most = std::max(most, Movement::kLinear);
  }
  return most;
}

// What the tree is built from, with no tree yet.
Bvh opened(BvhInput input, const BuildSettings& settings) {
  Bvh bvh;
  bvh.meshes = std::move(input.meshes);
  bvh.instances = std::move(input.instances);
  bvh.instance_controls = std::move(input.instance_controls);
  bvh.clocks = std::move(input.clocks);
  bvh.clock = std::move(input.clock);
  bvh.builder = settings.builder;
  return bvh;
}

Primitives primitives_of(const Bvh& bvh, std::span<const InstanceBounds> instance_bounds) {
  return {.meshes = bvh.meshes, .instances = instance_bounds, .swept = bvh.builder == Builder::kSwept};
}

template <typename T>
std::uint64_t bytes_of(const std::vector<T>& elements) {
  return elements.size() * sizeof(T);
}

void count_bytes(const Bvh& bvh, BvhStatistics& s) {
  s.instance_bytes = bytes_of(bvh.instances) + bytes_of(bvh.instance_controls) + bytes_of(bvh.clocks);
  for (const Clock& clock : bvh.clocks) s.instance_bytes += bytes_of(clock.pieces);
  s.other_bytes = bvh.arena.size() - s.node_bytes - s.leaf_bytes + bytes_of(bvh.root_bounds) +
                  bytes_of(bvh.slice_roots) + bytes_of(bvh.meshes) + sizeof(Bvh);
}

void finish(Bvh& bvh, std::span<const InstanceBounds> instance_bounds, std::uint64_t references) {
  bvh.max_level = std::max(bvh.max_level, level_of(finest_segments(bvh, instance_bounds)));
  bvh.instanced = !bvh.instances.empty();
  bvh.movement = movement_of(bvh);
  for (const auto& mesh : bvh.meshes) bvh.statistics.triangles += mesh->triangles.size();
  bvh.statistics.instances = bvh.instances.size();
  bvh.statistics.references = references;
  count_bytes(bvh, bvh.statistics);
}

BuiltBvh built(Bvh bvh, std::span<const InstanceBounds> instance_bounds, const BuildSettings& settings) {
  const std::uint32_t segments = finest_segments(bvh, instance_bounds);
  if (bvh.builder == Builder::kTimeSplit && segments > 1) {
    finish(bvh, instance_bounds, build_time_split(bvh, instance_bounds, segments, settings));
    bvh.statistics.built = 1;
    return {std::move(bvh), nullptr};
  }
  const Primitives primitives = primitives_of(bvh, instance_bounds);
  const Stopwatch topology_watch;
  Topology topology = build_topology(primitives, settings);
  bvh.statistics.topology_seconds = topology_watch.seconds();
  const Stopwatch bounds_watch;
  flatten(primitives, topology, settings, bvh);
  bvh.statistics.bounds_seconds = bounds_watch.seconds();
  bvh.statistics.built = 1;
  finish(bvh, instance_bounds, topology.reference_count);
  std::unique_ptr<KeptTopology> kept;
  if (settings.keep_topology) {
    kept = std::make_unique<KeptTopology>(keep(topology, primitives));
    kept->sah_cost = bvh.statistics.sah_cost;
    bvh.statistics.topology_bytes = kept->bytes();
  }
  return {std::move(bvh), std::move(kept)};
}

// False, with `bvh` as it was but for the time that it took, where the tree has become too dear.
bool refit(Bvh& bvh, KeptTopology& kept, std::span<const InstanceBounds> instance_bounds,
           const BuildSettings& settings) {
  const Stopwatch watch;
  Primitives primitives = primitives_of(bvh, instance_bounds);
  primitives.rest = kept.rest;
  Bvh refitted = bvh;
  flatten(primitives, kept.topology, settings, refitted);
  const bool dear = refitted.statistics.sah_cost > kept.sah_cost * double(settings.refit_drift);
  if (dear && settings.refit == Refit::kAuto) {
    bvh.statistics.refit_seconds = watch.seconds();
    return false;
  }
  bvh = std::move(refitted);
  bvh.statistics.refitted = 1;
  finish(bvh, instance_bounds, kept.topology.reference_count);
  bvh.statistics.bounds_seconds = bvh.statistics.refit_seconds = watch.seconds();
  return true;
}

}  // namespace

InstanceBounds instance_bounds_of(const Bvh& bvh, const Instance& instance) {
  const Bvh& object = *instance.object;
  return bound_instance(
      {{bvh.controls_of(instance), instance.form.controls()}, instance.form, bvh.clock_of(instance)},
      {object.root_bounds, object.root_form, &object.clock});
}

BuiltBvh build_bvh(BvhInput input, const BuildSettings& settings) {
  const Stopwatch total;
  Bvh bvh = opened(std::move(input), settings);
  const std::vector<InstanceBounds> instance_bounds = bound_instances(bvh);
  BuiltBvh result = built(std::move(bvh), instance_bounds, settings);
  result.bvh.statistics.build_seconds = total.seconds();
  return result;
}

BuiltBvh next_bvh(BvhInput input, const BuildSettings& settings, const Bvh& previous,
                  std::unique_ptr<KeptTopology>& topology) {
  if (settings.refit == Refit::kNever) return build_bvh(std::move(input), settings);
  const Stopwatch total;
  BuiltBvh result;
  Bvh bvh = opened(std::move(input), settings);
  if (is_unchanged(previous, bvh, settings.builder)) {
    result = {kept_tree(previous, std::move(bvh)), std::move(topology)};
  } else {
    const std::vector<InstanceBounds> instance_bounds = bound_instances(bvh);
    const bool fits = topology && can_refit(previous, *topology, bvh, instance_bounds, settings.builder);
    if (fits && refit(bvh, *topology, instance_bounds, settings)) {
      result = {std::move(bvh), std::move(topology)};
    } else {
      result = built(std::move(bvh), instance_bounds, settings);
    }
  }
  if (!settings.keep_topology) result.topology.reset();
  result.bvh.statistics.topology_bytes = result.topology ? result.topology->bytes() : 0;
  result.bvh.statistics.build_seconds = total.seconds();
  return result;
}

}  // namespace msbvh
