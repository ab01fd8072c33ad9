// Builds a tree: bounds of instances, topology, flattening.
#pragma once

#include <memory>
#include <vector>

#include "core/build/settings.h"
#include "core/bvh/bvh.h"

namespace msbvh {

// What goes into a tree. Instances' objects must not be instanced themselves.
struct BvhInput {
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;  // validated()
  std::vector<Instance> instances;
  std::vector<Affine3f> instance_controls;
  std::vector<Clock> clocks;                             // of instances, by their index
  Clock clock;                                           // of the tree itself, where it is instanced
  std::vector<std::shared_ptr<const GridMesh>> grids{};  // validated()
};

// What the tree says of an instance, for the builder and for verify().
InstanceBounds instance_bounds_of(const Bvh& bvh, const Instance& instance);

// Throws Cancelled when settings.cancelled says so; Error if the tree outgrows its 32-bit positions.
Bvh build_bvh(BvhInput input, const BuildSettings& settings);

}  // namespace msbvh
