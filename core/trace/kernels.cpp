#include "core/trace/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/trace/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/trace/stream-inl.h"
#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

// Kernels of a column of the table.
template <bool kInstanced, bool kGrids>
constexpr void fill_many(KernelTable& table) {
  constexpr std::size_t kContent = kInstanced + kGrids;
  table.intersect_many[0][kContent] = intersect_many<Movement::kStill, kInstanced, kGrids>;
  table.intersect_many[1][kContent] = intersect_many<Movement::kLinear, kInstanced, kGrids>;
  table.intersect_many[2][kContent] = intersect_many<Movement::kPolynomial, kInstanced, kGrids>;
  table.occluded_many[0][kContent] = occluded_many<Movement::kStill, kInstanced, kGrids>;
  table.occluded_many[1][kContent] = occluded_many<Movement::kLinear, kInstanced, kGrids>;
  table.occluded_many[2][kContent] = occluded_many<Movement::kPolynomial, kInstanced, kGrids>;
}

template <bool kInstanced, bool kGrids, bool kCount>
constexpr void fill_one(IntersectKernel (&closest)[3][3], OccludedKernel (&any)[3][3]) {
  constexpr std::size_t kContent = kInstanced + kGrids;
  closest[0][kContent] = intersect<Movement::kStill, kInstanced, kGrids, kCount>;
  closest[1][kContent] = intersect<Movement::kLinear, kInstanced, kGrids, kCount>;
  closest[2][kContent] = intersect<Movement::kPolynomial, kInstanced, kGrids, kCount>;
  any[0][kContent] = occluded<Movement::kStill, kInstanced, kGrids, kCount>;
  any[1][kContent] = occluded<Movement::kLinear, kInstanced, kGrids, kCount>;
  any[2][kContent] = occluded<Movement::kPolynomial, kInstanced, kGrids, kCount>;
}

template <bool kInstanced, bool kGrids>
constexpr void fill(KernelTable& table) {
  fill_many<kInstanced, kGrids>(table);
  fill_one<kInstanced, kGrids, false>(table.intersect, table.occluded);
  fill_one<kInstanced, kGrids, true>(table.intersect_counted, table.occluded_counted);
}

const KernelTable* kernel_table() {
  static const KernelTable kTable = [] {
    KernelTable table{};
    fill<false, false>(table);
    fill<true, false>(table);
    fill<true, true>(table);
    return table;
  }();
  return &kTable;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace msbvh {

const KernelTable* kernels_for(InstructionSet set) {
  // Asked once: the answer takes several CPUID instructions, each of which leaves a virtual machine, some 10 us
  // a call. A tree of a dozen triangles is built in half of that.
  static const std::int64_t supported = hwy::SupportedTargets();
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
