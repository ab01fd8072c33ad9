#include "core/trace/tracer.h"

#include <hwy/targets.h>
#include <string>

#include "core/base/error.h"
#include "core/bvh/bvh.h"
#include "core/bvh/known_kinds.h"
#include "core/trace/kernels.h"
#include "core/trace/ray_log.h"
#include "core/trace/trace_visit.h"

namespace msbvh {
namespace {

bool runs_here(InstructionSet set) {
  // Asked once: the answer takes several CPUID instructions, each of which leaves a virtual machine, some 10
  // us a call. A tree of a dozen triangles is built in half of that.
  static const std::int64_t supported = hwy::SupportedTargets();
  switch (set) {
    case InstructionSet::kSse4:
      return (supported & HWY_SSE4) != 0;
    case InstructionSet::kAvx2:
      return (supported & HWY_AVX2) != 0;
    case InstructionSet::kAvx3:
      return (supported & HWY_AVX3) != 0;
  }
  return false;
}

// Null where this machine, or this build, does not have the instruction set.
const Kernels* kernels_for(InstructionSet set, Movement movement, TreeLayout layout) {
  if (!runs_here(set)) return nullptr;
  const bool compact = layout == TreeLayout::kCompact;
  switch (movement) {
    case Movement::kStill:
      return compact ? compact_still_kernels(set) : still_kernels(set);
    case Movement::kLinear:
      return compact ? compact_linear_kernels(set) : linear_kernels(set);
    case Movement::kPolynomial:
      return compact ? compact_polynomial_kernels(set) : polynomial_kernels(set);
  }
  return nullptr;
}

InstructionSet best_instruction_set() {
  static const InstructionSet best = supported_instruction_sets().back();
  return best;
}

void log_closest(const Bvh& bvh, const Ray* rays, std::size_t count, Hit* hits, TraceModes& modes) {
  if (modes.log) modes.log->closest.insert(modes.log->closest.end(), rays, rays + count);
  Tracer(bvh).intersect({rays, count}, hits, modes);
}
void log_any(const Bvh& bvh, const Ray* rays, std::size_t count, bool* occluded, TraceModes& modes) {
  if (modes.log) modes.log->any.insert(modes.log->any.end(), rays, rays + count);
  Tracer(bvh).occluded({rays, count}, occluded, modes);
}

}  // namespace

std::vector<InstructionSet> supported_instruction_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : {InstructionSet::kSse4, InstructionSet::kAvx2, InstructionSet::kAvx3}) {
    if (kernels_for(set, Movement::kStill, TreeLayout::kFull)) sets.push_back(set);
  }
  if (sets.empty()) throw Error("this processor: no supported instruction set; expected at least SSE4.2");
  return sets;
}

const char* instruction_set_name(InstructionSet set) {
  switch (set) {
    case InstructionSet::kSse4:
      return "sse4";
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx3:
      return "avx3";
  }
  return "unknown";
}

void TraceCounts::add(const TraceVisit& visit) {
  nodes += visit.nodes;
  blocks += visit.blocks;
  primitives += visit.primitives;
  instances += visit.instances;
  if (visits) visits->push_back(visit);
}

Tracer::Tracer(const Bvh& bvh) : Tracer(bvh, best_instruction_set()) {}

Tracer::Tracer(const Bvh& bvh, InstructionSet set) : bvh_(&bvh) {
  const Kernels* kernels = kernels_for(set, bvh.movement, bvh.layout);
  if (!kernels) {
    throw Error(std::string("instruction set ") + instruction_set_name(set) +
                ": found no kernels that this processor can run in this build");
  }
  const std::size_t leaves = kernel_set_for(bvh.leaf_kinds);
  if (!kernels->intersect[leaves] || bvh.leaf_kinds.without(kOmittedKinds) != bvh.leaf_kinds) {
    throw Error(
        "tree: found motion or geometry that this build leaves out; expected none of MSBVH_OMIT_EFFECTS");
  }
  intersect_ = kernels->intersect[leaves];
  intersect_many_ = kernels->intersect_many[leaves][bvh.still_parts];
  occluded_many_ = kernels->occluded_many[leaves][bvh.still_parts];
  occluded_ = kernels->occluded[leaves];
  intersect_counted_ = kernels->intersect_counted[leaves];
  occluded_counted_ = kernels->occluded_counted[leaves];
}

Tracer Tracer::logging(const Bvh& bvh) {
  Tracer tracer(bvh);
  tracer.intersect_many_ = log_closest;
  tracer.occluded_many_ = log_any;
  return tracer;
}

bool Tracer::intersect_counted(const Ray& ray, Hit& hit, TraceCounts& counts) const {
  return intersect_counted_(*bvh_, ray, hit, &counts);
}
bool Tracer::occluded_counted(const Ray& ray, TraceCounts& counts) const {
  return occluded_counted_(*bvh_, ray, &counts);
}

}  // namespace msbvh
