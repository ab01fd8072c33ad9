#include "core/trace/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/trace/stream-inl.h"
#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

template <bool kInstanced>
constexpr void fill_many(KernelTable& table) {
  table.intersect_many[0][kInstanced] = intersect_many<Movement::kStill, kInstanced>;
  table.intersect_many[1][kInstanced] = intersect_many<Movement::kLinear, kInstanced>;
  table.intersect_many[2][kInstanced] = intersect_many<Movement::kPolynomial, kInstanced>;
  table.occluded_many[0][kInstanced] = occluded_many<Movement::kStill, kInstanced>;
  table.occluded_many[1][kInstanced] = occluded_many<Movement::kLinear, kInstanced>;
  table.occluded_many[2][kInstanced] = occluded_many<Movement::kPolynomial, kInstanced>;
}

template <bool kCount>
constexpr void fill(IntersectKernel (&closest)[3][2], OccludedKernel (&any)[3][2]) {
  closest[0][0] = intersect<Movement::kStill, false, kCount>;
  closest[0][1] = intersect<Movement::kStill, true, kCount>;
  closest[1][0] = intersect<Movement::kLinear, false, kCount>;
  closest[1][1] = intersect<Movement::kLinear, true, kCount>;
  closest[2][0] = intersect<Movement::kPolynomial, false, kCount>;
  closest[2][1] = intersect<Movement::kPolynomial, true, kCount>;
  any[0][0] = occluded<Movement::kStill, false, kCount>;
  any[0][1] = occluded<Movement::kStill, true, kCount>;
  any[1][0] = occluded<Movement::kLinear, false, kCount>;
  any[1][1] = occluded<Movement::kLinear, true, kCount>;
  any[2][0] = occluded<Movement::kPolynomial, false, kCount>;
  any[2][1] = occluded<Movement::kPolynomial, true, kCount>;
}

const KernelTable* kernel_table() {
  static const KernelTable kTable = [] {
    KernelTable table{};
    fill_many<false>(table);
    fill_many<true>(table);
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
