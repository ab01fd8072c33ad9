#include "core/bvh/build_bvh.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/base/stopwatch.h"
#include "core/build/topology.h"
#include "core/bvh/flatten.h"
#include "core/bvh/instance_bounds.h"
#include "core/bvh/rebraid.h"
#include "core/bvh/refit.h"
#include "core/bvh/time_split.h"

namespace msbvh {
namespace {

Movement movement_of(const TrackForm& form) {
  if (!form.moving()) return Movement::kStill;
  return form.degree == 1 ? Movement::kLinear : Movement::kPolynomial;
}

// An instance that is there for a part of the shutter moves, in that a ray's time matters.
Movement movement_of(const Bvh& bvh) {
  Movement most = movement_of(bvh.root_form);  // still where the tree is swept
  for (const auto& mesh : bvh.meshes) most = std::max(most, movement_of(mesh->form()));
  for (const auto& mesh : bvh.grids) most = std::max(most, movement_of(mesh->form()));
  for (const auto& set : bvh.curves) most = std::max(most, movement_of(set->form()));
  for (const auto& set : bvh.points) most = std::max(most, movement_of(set->form()));
  for (const Instance& i : bvh.instances) {
    most = std::max({most, movement_of(i.form), i.object->movement});
    const bool remapped = i.time_remap != kNoTimeRemap || !i.object->time_remap.is_shutter();
    if (remapped) most = std::max(most, Movement::kLinear);
  }
  return most;
}

// What the tree is built from, with no tree yet.
Bvh opened(BvhInput input, const BuildSettings& settings) {
  Bvh bvh;
  bvh.meshes = std::move(input.meshes);
  bvh.grids = std::move(input.grids);
  bvh.curves = std::move(input.curves);
  bvh.points = std::move(input.points);
  bvh.instances = std::move(input.instances);
  bvh.instance_controls = std::move(input.instance_controls);
  bvh.time_remaps = std::move(input.time_remaps);
  bvh.time_remap = std::move(input.time_remap);
  bvh.builder = settings.builder;
  bvh.layout = settings.layout;
  for (std::size_t i = 0; i < bvh.instances.size(); ++i) {
    if (bvh.instances[i].object->layout == bvh.layout) continue;
    throw Error("accelerator: instance " + std::to_string(i) +
                " shows a tree of another layout; expected the same in every tree");
  }
  return bvh;
}

Primitives primitives_of(const Bvh& bvh, const InstanceParts& instances) {
  return {.meshes = bvh.meshes,
          .instances = instances.bounds,
          .grids = bvh.grids,
          .curves = bvh.curves,
          .points = bvh.points,
          .parts = instances.parts,
          .whole_spans = bvh.builder != Builder::kMsbvh,
          .indexed_leaves = bvh.layout == TreeLayout::kCompact,
          .swept = bvh.builder == Builder::kSwept};
}

template <typename T>
std::uint64_t bytes_of(const std::vector<T>& elements) {
  return elements.size() * sizeof(T);
}

void count_bytes(const Bvh& bvh, BvhStatistics& s) {
  s.instance_bytes = bytes_of(bvh.instances) + bytes_of(bvh.instance_controls) + bytes_of(bvh.time_remaps);
  for (const TimeRemap& time_remap : bvh.time_remaps) s.instance_bytes += bytes_of(time_remap.pieces);
  s.other_bytes = bvh.arena.size() - s.node_bytes - s.leaf_bytes + bytes_of(bvh.root_bounds) +
                  bytes_of(bvh.slice_roots) + bytes_of(bvh.meshes) + bytes_of(bvh.grids) +
                  bytes_of(bvh.curves) + bytes_of(bvh.points) + sizeof(Bvh);
}

LeafKinds leaf_kinds_of(const Bvh& bvh) {
  LeafKinds kinds;
  if (!bvh.meshes.empty()) kinds.add(LeafKind::kTriangles);
  if (!bvh.grids.empty()) kinds.add(LeafKind::kGrids);
  if (!bvh.curves.empty()) kinds.add(LeafKind::kCurves);
  if (!bvh.points.empty()) kinds.add(LeafKind::kPoints);
  for (const Instance& instance : bvh.instances) {
    kinds.add(LeafKind::kInstances);
    kinds.add(instance.object->leaf_kinds);
  }
  return kinds;
}

void finish(Bvh& bvh, const InstanceParts& instances, std::uint64_t references) {
  bvh.max_level =
      std::max({bvh.max_level, bvh.slice_level, level_of(finest_segments(bvh, instances.bounds))});
  bvh.leaf_kinds = leaf_kinds_of(bvh);
  bvh.movement = movement_of(bvh);
  for (const auto& mesh : bvh.meshes) bvh.statistics.triangles += mesh->triangles.size();
  for (const auto& mesh : bvh.grids) {
    bvh.statistics.patches += mesh->patches.size();
    bvh.statistics.quads += mesh->quad_count;
    bvh.statistics.grid_bytes += mesh->values.size() * sizeof(float);
  }
  for (const auto& set : bvh.curves) {
    bvh.statistics.spans += set->spans.size();
    bvh.statistics.round_bytes += bytes_of(set->vertices);
  }
  for (const auto& set : bvh.points) {
    bvh.statistics.points += set->point_count;
    bvh.statistics.round_bytes += bytes_of(set->vertices);
  }
  bvh.statistics.instances = bvh.instances.size();
  bvh.statistics.references = references;
  count_bytes(bvh, bvh.statistics);
}

bool has_curves(const Bvh& bvh, std::span<const InstanceBounds> instance_bounds) {
  const auto curved = [](const auto& mesh) { return mesh->degree > 1; };
  return std::ranges::any_of(bvh.meshes, curved) || std::ranges::any_of(bvh.grids, curved) ||
         std::ranges::any_of(bvh.curves, curved) || std::ranges::any_of(bvh.points, curved) ||
         std::ranges::any_of(instance_bounds, [](const InstanceBounds& b) { return b.form.degree > 1; });
}

// How many slices the settings ask for, whatever moves how.
std::uint32_t time_slices(const Bvh& bvh, std::span<const InstanceBounds> instance_bounds,
                          const BuildSettings& settings) {
  if (!is_valid_segment_count(settings.time_slices)) {
    throw Error("accelerator: time_slices is " + std::to_string(settings.time_slices) +
                "; expected 0 or a power of two up to " + std::to_string(kMaxSegments));
  }
  const std::uint32_t finest = finest_segments(bvh, instance_bounds);
  if (bvh.builder == Builder::kTimeSplit) return finest;
  if (finest == 0 || settings.time_slices == 0 || bvh.builder == Builder::kSwept) return 1;
  return has_curves(bvh, instance_bounds) ? std::max(settings.time_slices, finest) : settings.time_slices;
}

// Where a good part of what the topology holds moves incoherently, trees for parts of the shutter have fewer
// nodes a ray; but their leaves are indexed, so that they pay only where those of one tree are as well.
bool wants_slices(const Bvh& bvh, std::span<const InstanceBounds> instance_bounds, const Topology& topology,
                  const BuildSettings& settings) {
  return settings.time_slices == 0 && bvh.builder == Builder::kMsbvh &&
         4 * topology.incoherent_references > topology.reference_count &&
         level_of(finest_segments(bvh, instance_bounds)) > kMaxGatheredLevel &&
         !has_curves(bvh, instance_bounds);
}

BuiltBvh sliced(Bvh bvh, const InstanceParts& instances, std::uint32_t slices,
                const BuildSettings& settings) {
  finish(bvh, instances, build_time_split(bvh, instances, slices, settings));
  bvh.statistics.built = 1;
  return {std::move(bvh), nullptr};
}

// `whole`: whole_instances().
BuiltBvh built(Bvh bvh, InstanceParts whole, const BuildSettings& settings) {
  const Stopwatch topology_watch;
  const InstanceParts instances = rebraided(bvh, std::move(whole), settings);
  const std::uint32_t slices = time_slices(bvh, instances.bounds, settings);
  if (slices > 1) return sliced(std::move(bvh), instances, slices, settings);
  const Primitives primitives = primitives_of(bvh, instances);
  Topology topology = build_topology(primitives, settings);
  if (wants_slices(bvh, instances.bounds, topology, settings))
    return sliced(std::move(bvh), instances, kIncoherentSlices, settings);
  bvh.statistics.topology_seconds = topology_watch.seconds();
  const Stopwatch bounds_watch;
  flatten(primitives, topology, settings, bvh);
  bvh.statistics.bounds_seconds = bounds_watch.seconds();
  bvh.statistics.built = 1;
  finish(bvh, instances, topology.reference_count);
  std::unique_ptr<KeptTopology> kept;
  if (settings.keep_topology) {
    kept = std::make_unique<KeptTopology>(keep(topology, primitives));
    kept->sah_cost = bvh.statistics.sah_cost;
    bvh.statistics.topology_bytes = kept->bytes();
  }
  return {std::move(bvh), std::move(kept)};
}

// False, with `bvh` as it was but for the time that it took, where the tree has become too expensive.
bool refit(Bvh& bvh, KeptTopology& kept, const InstanceParts& instances, const BuildSettings& settings) {
  const Stopwatch watch;
  Primitives primitives = primitives_of(bvh, instances);
  primitives.rest = kept.rest;
  primitives.rest_grids = kept.rest_grids;
  Bvh refitted = bvh;
  flatten(primitives, kept.topology, settings, refitted);
  const bool too_expensive = refitted.statistics.sah_cost > kept.sah_cost * double(settings.refit_drift);
  if (too_expensive && settings.refit == Refit::kAuto) {
    bvh.statistics.refit_seconds = watch.seconds();
    return false;
  }
  bvh = std::move(refitted);
  bvh.statistics.refitted = 1;
  finish(bvh, instances, kept.topology.reference_count);
  bvh.statistics.bounds_seconds = bvh.statistics.refit_seconds = watch.seconds();
  return true;
}

}  // namespace

InstanceBounds instance_bounds_of(const Bvh& bvh, const Instance& instance) {
  const Bvh& object = *instance.object;
  return bound_instance(
      {{bvh.controls_of(instance), instance.form.controls()}, instance.form, bvh.time_remap_of(instance)},
      {object.root_bounds, object.root_form, &object.time_remap});
}

BuiltBvh build_bvh(BvhInput input, const BuildSettings& settings) {
  const Stopwatch total;
  Bvh bvh = opened(std::move(input), settings);
  InstanceParts instances = whole_instances(bvh);
  BuiltBvh result = built(std::move(bvh), std::move(instances), settings);
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
    InstanceParts instances;
    bool fits = topology && can_refit(previous, *topology, bvh, settings.builder);
    if (fits) {
      instances = kept_parts(bvh, topology->parts);
      fits = is_there(*topology, instances.bounds) && refit(bvh, *topology, instances, settings);
    }
    if (fits) {
      result = {std::move(bvh), std::move(topology)};
    } else {
      instances = whole_instances(bvh);
      result = built(std::move(bvh), std::move(instances), settings);
    }
  }
  if (!settings.keep_topology) result.topology.reset();
  result.bvh.statistics.topology_bytes = result.topology ? result.topology->bytes() : 0;
  result.bvh.statistics.build_seconds = total.seconds();
  return result;
}

}  // namespace msbvh
