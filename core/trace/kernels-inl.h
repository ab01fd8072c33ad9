// The kernels of one Movement for one instruction set; instantiated in core/trace/kernels_*.cpp.

#if defined(MSBVH_KERNELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_KERNELS_INL_H
#undef MSBVH_KERNELS_INL_H
#else
#define MSBVH_KERNELS_INL_H
#endif

#include "core/trace/kernels.h"
#include "core/trace/stream-inl.h"
#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

template <Movement kMovement, bool kInstanced, bool kGrids>
constexpr void fill(Kernels& kernels) {
  constexpr std::size_t kContent = kInstanced + kGrids;
  kernels.intersect[kContent] = intersect<kMovement, kInstanced, kGrids, false>;
  kernels.intersect_many[kContent] = intersect_many<kMovement, kInstanced, kGrids>;
  kernels.occluded_many[kContent] = occluded_many<kMovement, kInstanced, kGrids>;
  kernels.occluded[kContent] = occluded<kMovement, kInstanced, kGrids, false>;
  kernels.intersect_counted[kContent] = intersect<kMovement, kInstanced, kGrids, true>;
  kernels.occluded_counted[kContent] = occluded<kMovement, kInstanced, kGrids, true>;
}

template <Movement kMovement>
constexpr Kernels kernels_of() {
  Kernels kernels{};
  fill<kMovement, false, false>(kernels);
  fill<kMovement, true, false>(kernels);
  fill<kMovement, true, true>(kernels);
  return kernels;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
