#include "core/trace/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

template <Movement kMovement, bool kCount>
constexpr void fill_row(IntersectKernel (&closest)[3], OccludedKernel (&any)[3]) {
  closest[0] = intersect<kMovement, false, false, kCount>;
  closest[1] = intersect<kMovement, true, false, kCount>;
  closest[2] = intersect<kMovement, true, true, kCount>;
  any[0] = occluded<kMovement, false, false, kCount>;
  any[1] = occluded<kMovement, true, false, kCount>;
  any[2] = occluded<kMovement, true, true, kCount>;
}

template <bool kCount>
constexpr void fill(IntersectKernel (&closest)[3][3], OccludedKernel (&any)[3][3]) {
  fill_row<Movement::kStill, kCount>(closest[0], any[0]);
  fill_row<Movement::kLinear, kCount>(closest[1], any[1]);
  fill_row<Movement::kPolynomial, kCount>(closest[2], any[2]);
}

const KernelTable* kernel_table() {
  static const KernelTable kTable = [] {
    KernelTable table{};
    fill<false>(table.intersect, table.occluded);
    fill<true>(table.intersect_counted, table.occluded_counted);
    return table;
  }();
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
