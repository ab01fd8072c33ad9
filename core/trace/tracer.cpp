#include "core/trace/tracer.h"

#include <string>

#include "core/base/error.h"
#include "core/bvh/bvh.h"
#include "core/trace/kernels.h"

namespace msbvh {
namespace {

InstructionSet best_instruction_set() {
  static const InstructionSet best = supported_instruction_sets().back();
  return best;
}

}  // namespace

std::vector<InstructionSet> supported_instruction_sets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : {InstructionSet::kSse4, InstructionSet::kAvx2, InstructionSet::kAvx3}) {
    if (kernels_for(set)) sets.push_back(set);
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

Tracer::Tracer(const Bvh& bvh) : Tracer(bvh, best_instruction_set()) {}

Tracer::Tracer(const Bvh& bvh, InstructionSet set) : bvh_(&bvh) {
  const KernelTable* table = kernels_for(set);
  if (!table) throw Error(std::string("this processor does not support ") + instruction_set_name(set));
  const auto movement = static_cast<std::size_t>(bvh.movement),
             content = bvh.gridded ? std::size_t(2) : bvh.instanced;
  intersect_ = table->intersect[movement][content];
  intersect_many_ = table->intersect_many[movement][content];
  occluded_many_ = table->occluded_many[movement][content];
  occluded_ = table->occluded[movement][content];
  intersect_counted_ = table->intersect_counted[movement][content];
  occluded_counted_ = table->occluded_counted[movement][content];
}

bool Tracer::intersect_counted(const Ray& ray, Hit& hit, TraceCounts& counts) const {
  return intersect_counted_(*bvh_, ray, hit, &counts);
}
bool Tracer::occluded_counted(const Ray& ray, TraceCounts& counts) const {
  return occluded_counted_(*bvh_, ray, &counts);
}

}  // namespace msbvh
