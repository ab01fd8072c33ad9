// What a build leaves behind for the frames that follow: the topology, which a refit spares them.
#pragma once

#include <vector>

#include "core/build/reference.h"
#include "core/build/topology.h"

namespace msbvh {

struct KeptTopology {
  Topology topology;           // without unused slots
  std::vector<RestPose> rest;  // Primitives::rest of every refit
  std::vector<std::shared_ptr<const GridMesh>> rest_grids;
  std::vector<InstancePart> parts;  // Primitives::parts
  std::vector<bool> there;          // by part: whether anything refers to it
  double sah_cost = 0.0;            // of the tree when it was built

  std::size_t bytes() const;
};

KeptTopology keep(const Topology& topology, const Primitives& primitives);

}  // namespace msbvh
