// The traversal kernels that are compiled once for each instruction set.
#pragma once

#include "core/bvh/bvh.h"
#include "core/bvh/leaf_kinds.h"
#include "core/trace/ray.h"
#include "core/trace/tracer.h"

namespace msbvh {

using IntersectKernel = bool (*)(const Bvh&, const Ray&, Hit&, TraceCounts*);
using IntersectManyKernel = void (*)(const Bvh&, const Ray*, std::size_t, Hit*, TraceModes&);
using OccludedManyKernel = void (*)(const Bvh&, const Ray*, std::size_t, bool*, TraceModes&);
using OccludedKernel = bool (*)(const Bvh&, const Ray&, TraceCounts*);

// Of trees that move in one way (Movement), a kernel for each of kKernelKinds: the still ones know no time,
// the linear ones no curves, and none knows of leaves that its set does not have.
struct Kernels {
  IntersectKernel intersect[kKernelSets];
  // The second ones take steps that know no time in still subtrees of trees that move (Bvh::still_parts).
  IntersectManyKernel intersect_many[kKernelSets][2];
  OccludedManyKernel occluded_many[kKernelSets][2];
  OccludedKernel occluded[kKernelSets];
  IntersectKernel intersect_counted[kKernelSets];
  OccludedKernel occluded_counted[kKernelSets];
};

// Each in a file of its own, since they take long to compile. Null where the instruction set was not
// compiled.
const Kernels* still_kernels(InstructionSet set);
const Kernels* linear_kernels(InstructionSet set);
const Kernels* polynomial_kernels(InstructionSet set);
// Of compact trees (TreeLayout).
const Kernels* compact_still_kernels(InstructionSet set);
const Kernels* compact_linear_kernels(InstructionSet set);
const Kernels* compact_polynomial_kernels(InstructionSet set);

}  // namespace msbvh
