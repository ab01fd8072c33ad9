// The invariants of a tree, as code.
#pragma once

#include "core/build/reference.h"
#include "core/bvh/bvh.h"

namespace msbvh {

// Proves, at every key of every track involved and without tolerance:
//   - the layout: positions inside the arena, levels that nest, counts, absent slots that nothing can hit;
//   - a node's slot contains every slot of the child node at every key of either (invariant 5);
//   - a leaf's slot contains its instances, and of each of its triangles the whole or, where fragments of it
//   lie in
//     several leaves, these together: the slots' union holds the triangle at dense barycentric samples
//     (invariant 4);
//   - every triangle and every instance with something in it is in some leaf; where an instance is in parts,
//   these are a cut through its object's tree, each part within its leaf's slot.
// Throws Error naming the node's position and what is violated. For tests: takes seconds on large trees.
void verify(const Bvh& bvh);

}  // namespace msbvh
