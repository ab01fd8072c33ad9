// The traversal kernels that are compiled once for each instruction set.
#pragma once

#include "core/bvh/bvh.h"
#include "core/trace/ray.h"
#include "core/trace/tracer.h"

namespace msbvh {

using IntersectKernel = bool (*)(const Bvh&, const Ray&, Hit&, TraceCounts*);
using IntersectManyKernel = void (*)(const Bvh&, const Ray*, std::size_t, Hit*, TraceModes&);
using OccludedManyKernel = void (*)(const Bvh&, const Ray*, std::size_t, bool*, TraceModes&);
using OccludedKernel = bool (*)(const Bvh&, const Ray&, TraceCounts*);

// Of trees that move in one way (Movement). Index: what a tree holds beside triangles (nothing, instances,
// instances and grids). What a tree does not hold costs no instruction: the still kernels know no time, the
// linear ones no curves, the flat ones no transforms, and only the last ones know grids.
struct Kernels {
  IntersectKernel intersect[3];
  IntersectManyKernel intersect_many[3];
  OccludedManyKernel occluded_many[3];
  OccludedKernel occluded[3];
  IntersectKernel intersect_counted[3];
  OccludedKernel occluded_counted[3];
};

// Each in a file of its own, since they take long to compile. Null where the instruction set was not
// compiled.
const Kernels* still_kernels(InstructionSet set);
const Kernels* linear_kernels(InstructionSet set);
const Kernels* polynomial_kernels(InstructionSet set);

}  // namespace msbvh
