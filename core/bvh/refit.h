// What the tree of one frame can be for the next one.
//
// Kept: nothing that it was built from has changed, bit by bit. Refitted: the topology (which references
// share a node) is evaluated at the new frame's keys, bottom-up. That is always right: boxes come from the
// new keys alone, and fragments are material, cut in the pose of the frame in which the topology was built
// and moved from there, whatever the pose of the new frame. The SAH cost estimates how much longer rays take.
#pragma once

#include "core/build/kept_topology.h"
#include "core/bvh/bvh.h"

namespace msbvh {

// `next` has its meshes, instances and time remaps, and no tree yet.
bool is_unchanged(const Bvh& previous, const Bvh& next, Builder builder);

// Whether the topology of `previous` is one of `next`: as many meshes with the same triangles, grids
// with the same patches, as many instances, and the same of them visible (is_there(), of the parts that it
// was kept with). Forms, key counts and time remaps may differ. Where instances are braided, their parts are
// places in objects' trees, which must be the very same.
bool can_refit(const Bvh& previous, const KeptTopology& topology, const Bvh& next, Builder builder);
bool is_there(const KeptTopology& topology, std::span<const InstanceBounds> next_parts);

// The tree of `previous` over the meshes and objects of `next`, which is_unchanged().
Bvh kept_tree(const Bvh& previous, Bvh next);

}  // namespace msbvh
