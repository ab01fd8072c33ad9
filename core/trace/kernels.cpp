#include "core/trace/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

const KernelTable* kernel_table() {
  static constexpr KernelTable kTable = {
      {{intersect<false, false, false>, intersect<false, true, false>},
       {intersect<true, false, false>, intersect<true, true, false>}},
      {{occluded<false, false, false>, occluded<false, true, false>},
       {occluded<true, false, false>, occluded<true, true, false>}},
      {{intersect<false, false, true>, intersect<false, true, true>},
       {intersect<true, false, true>, intersect<true, true, true>}},
      {{occluded<false, false, true>, occluded<false, true, true>},
       {occluded<true, false, true>, occluded<true, true, true>}},
  };
  return &kTable;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace msbvh {

const KernelTable* kernels_for(InstructionSet set) {
  const std::int64_t supported = hwy::SupportedTargets();
  switch (set) {
    case InstructionSet::kSse4:
      return (supported & HWY_SSE4) ? N_SSE4::kernel_table() : nullptr;
    case InstructionSet::kAvx2:
      return (supported & HWY_AVX2) ? N_AVX2::kernel_table() : nullptr;
    case InstructionSet::kAvx3:
      return (supported & HWY_AVX3) ? N_AVX3::kernel_table() : nullptr;
  }
  return nullptr;
}

}  // namespace msbvh
#endif
