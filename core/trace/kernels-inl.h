// The kernels of one Movement for one instruction set; instantiated in core/trace/kernels_*.cpp.

#if defined(MSBVH_KERNELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_KERNELS_INL_H
#undef MSBVH_KERNELS_INL_H
#else
#define MSBVH_KERNELS_INL_H
#endif

#include <cstddef>
#include <utility>

#include "core/bvh/known_kinds.h"
#include "core/trace/kernels.h"
#include "core/trace/stream-inl.h"
#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

// Whether the build has kernels for it (MSBVH_OMIT_EFFECTS); if not, all of them are null.
constexpr bool is_known(Movement movement) {
  return movement == Movement::kPolynomial ? kKnownPolynomialMotion
         : movement == Movement::kLinear   ? kKnownLinearMotion
                                           : true;
}

template <Movement kMovement, std::size_t kSet>
constexpr void fill(Kernels& kernels) {
  constexpr LeafKinds kKinds = kKernelKinds[kSet].without(kOmittedKinds);
  kernels.intersect[kSet] = intersect<kMovement, kKinds, false>;
  constexpr bool kMixed = kMovement != Movement::kStill;
  kernels.intersect_many[kSet][0] = intersect_many<kMovement, kKinds, false>;
  kernels.intersect_many[kSet][1] = intersect_many<kMovement, kKinds, kMixed>;
  kernels.occluded_many[kSet][0] = occluded_many<kMovement, kKinds, false>;
  kernels.occluded_many[kSet][1] = occluded_many<kMovement, kKinds, kMixed>;
  kernels.occluded[kSet] = occluded<kMovement, kKinds, false>;
  kernels.intersect_counted[kSet] = intersect<kMovement, kKinds, true>;
  kernels.occluded_counted[kSet] = occluded<kMovement, kKinds, true>;
}

// Of compact trees: with triangles alone, or with anything; these take no steps of their own in
// still subtrees.
template <Movement kMovement, std::size_t kSet>
constexpr void fill_compact(Kernels& kernels, std::size_t set) {
  constexpr LeafKinds kKinds = kKernelKinds[kSet].without(kOmittedKinds).with(LeafKind::kCompactTree);
  kernels.intersect[set] = intersect<kMovement, kKinds, false>;
  kernels.occluded[set] = occluded<kMovement, kKinds, false>;
  kernels.intersect_counted[set] = intersect<kMovement, kKinds, true>;
  kernels.occluded_counted[set] = occluded<kMovement, kKinds, true>;
  constexpr bool kMixed = kSet == 0 && kMovement != Movement::kStill;
  kernels.intersect_many[set][0] = intersect_many<kMovement, kKinds, false>;
  kernels.intersect_many[set][1] = intersect_many<kMovement, kKinds, kMixed>;
  kernels.occluded_many[set][0] = occluded_many<kMovement, kKinds, false>;
  kernels.occluded_many[set][1] = occluded_many<kMovement, kKinds, kMixed>;
}
template <Movement kMovement>
constexpr Kernels compact_kernels_of() {
  Kernels kernels{};
  if constexpr (is_known(kMovement)) {
    fill_compact<kMovement, 0>(kernels, 0);
    for (std::size_t set = 1; set < kKernelSets; ++set)
      fill_compact<kMovement, kKernelSets - 1>(kernels, set);
  }
  return kernels;
}

template <Movement kMovement>
constexpr Kernels kernels_of() {
  Kernels kernels{};
  if constexpr (is_known(kMovement)) {
    [&]<std::size_t... kSets>(std::index_sequence<kSets...>) {
      (fill<kMovement, kSets>(kernels), ...);
    }(std::make_index_sequence<kKernelSets>());
  }
  return kernels;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
