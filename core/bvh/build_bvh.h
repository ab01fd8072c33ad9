// Builds a tree: bounds of instances, topology, flattening. Or makes it from that of the frame before.
#pragma once

#include <memory>
#include <vector>

#include "core/build/kept_topology.h"
#include "core/build/settings.h"
#include "core/bvh/bvh.h"

namespace msbvh {

// What goes into a tree. Instances' objects must not be instanced themselves.
struct BvhInput {
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;  // validated()
  std::vector<Instance> instances;
  std::vector<Affine3f> instance_controls;
  std::vector<TimeRemap> time_remaps;                    // of instances, by their index
  TimeRemap time_remap;                                  // of the tree itself, where it is instanced
  std::vector<std::shared_ptr<const GridMesh>> grids{};  // validated()
  std::vector<std::shared_ptr<const CurveSet>> curves{};
  std::vector<std::shared_ptr<const PointSet>> points{};
};

// What the tree says of an instance, for the builder and for verify().
InstanceBounds instance_bounds_of(const Bvh& bvh, const Instance& instance);

struct BuiltBvh {
  Bvh bvh;
  std::unique_ptr<KeptTopology> topology;  // null unless settings.keep_topology
};

// Throws Cancelled when settings.cancelled says so; Error if the tree outgrows its 32-bit positions.
BuiltBvh build_bvh(BvhInput input, const BuildSettings& settings);

// The tree of the frame after `previous`, as settings.refit says: kept, refitted or built. `topology` is what
// the build of `previous` has left, null for nothing; it is moved on, unless something is thrown.
BuiltBvh next_bvh(BvhInput input, const BuildSettings& settings, const Bvh& previous,
                  std::unique_ptr<KeptTopology>& topology);

}  // namespace msbvh
