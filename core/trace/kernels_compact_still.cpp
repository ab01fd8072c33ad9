#include "core/trace/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/kernels_compact_still.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/trace/kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

const Kernels* compact_still_kernels() {
  static constexpr Kernels kKernels = compact_kernels_of<Movement::kStill>();
  return &kKernels;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace msbvh {

const Kernels* compact_still_kernels(InstructionSet set) {
  switch (set) {
#if HWY_TARGETS & HWY_SSE4
    case InstructionSet::kSse4:
      return N_SSE4::compact_still_kernels();
#endif
#if HWY_TARGETS & HWY_AVX2
    case InstructionSet::kAvx2:
      return N_AVX2::compact_still_kernels();
#endif
#if HWY_TARGETS & HWY_AVX3
    case InstructionSet::kAvx3:
      return N_AVX3::compact_still_kernels();
#endif
    default:
      return nullptr;
  }
}

}  // namespace msbvh
#endif
