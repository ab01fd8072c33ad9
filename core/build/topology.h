// The binary topology of a tree, chosen at the shutter's centre, or over the shutter where motion is
// incoherent: step 1 of the paper's construction
// (section 3.1).
#pragma once

#include <cstdint>

#include "core/build/raw_array.h"
#include "core/build/reference.h"
#include "core/build/settings.h"

namespace msbvh {

struct BinaryNode {
  float lo[3], hi[3];   // at the shutter's centre
  std::uint32_t first;  // leaf: first reference; inner: left child, the right one is next to it
  std::uint32_t count;  // leaf: number of references, > 0; inner: 0

  float area;  // what its half area is to the SAH: at the centre, or averaged over the shutter

  bool is_leaf() const { return count > 0; }
  float half_area() const { return area; }
};

struct Topology {
  RawArray<BinaryNode> nodes;               // node 0 is the root
  std::uint32_t node_count = 0;             // up to the last one in use; 0: nothing in the tree
  RawArray<Reference> references;           // leaves own ranges of it; what lies between is unused
  std::uint64_t reference_count = 0;        // in leaves
  std::uint64_t incoherent_references = 0;  // of them in subtrees whose motion is incoherent

  const BinaryNode& root() const { return nodes[0]; }
};

// Deterministic: the same tree for any number of threads (the numbering of nodes may differ).
// Throws Cancelled when settings.cancelled says so.
Topology build_topology(const Primitives& primitives, const BuildSettings& settings);

}  // namespace msbvh
