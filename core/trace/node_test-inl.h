// A ray against the 8 boxes of a node at the ray's time.
//
// Slab test with a factor on the far distance: T. Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013. Ize's
// factor covers the three roundings of each slab distance. Ours, kFarFactor, covers the triangle test's
// roundings as well (each vertex is moved by at most 5 roundings relative to its distance from the origin,
// component by component), so that whatever the triangle test would accept lies in a box that this test
// accepts: docs/design/watertight.md.

#if defined(MSBVH_NODE_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_NODE_TEST_INL_H
#undef MSBVH_NODE_TEST_INL_H
#else
#define MSBVH_NODE_TEST_INL_H
#endif

#include <hwy/highway.h>

#include "core/bvh/bvh.h"
#include "core/trace/ray_setup-inl.h"
#include "core/trace/simd_lerp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// 16 roundings of 2^-24: 8 each on the near and on the far distance.
constexpr float kFarFactor = 1.0f + 0x1p-20f;

// Distances of the 8 boxes in `distance` (valid where hit), a bit for each box that is hit in [tnear, tfar].
//
// A direction of 0 makes the reciprocal infinite and 0 * inf a NaN when the origin lies exactly on a plane.
// x86's max and min return their second operand then: the plane bounds nothing, and the box counts as
// entered.
//
// `first` is the first control in force at the ray's time. Boxes of a node are aligned to cache lines, those
// of a grid's tiles are not.
template <Movement kMovement, bool kAligned>
HWY_INLINE std::uint32_t test_boxes(const NodeBounds* controls, bool moving, std::uint32_t degree,
                                    SegmentTime at, const RaySetup<kMovement>& ray, float tfar,
                                    float* distance) {
  const hn::CappedTag<float, kWidth> d;
  using V = hn::Vec<decltype(d)>;
  constexpr std::size_t kFloatsPerControl = sizeof(NodeBounds) / sizeof(float);
  const float* first = reinterpret_cast<const float*>(controls);
  const Weights<decltype(d)> weights(d, at.w);

  std::uint32_t hits = 0;
  for (std::size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    const auto slab = [&](std::uint32_t plane, int axis) {
      const float* p = first + plane + lane;
      const auto control = [&](std::uint32_t i) {
        const float* from = p + i * kFloatsPerControl;
        return kAligned ? hn::Load(d, from) : hn::LoadU(d, from);
      };
      const V x = moving ? simd_bezier(control, degree, weights) : control(0);
      return hn::Mul(hn::Sub(x, hn::Set(d, ray.org[axis])), hn::Set(d, ray.reciprocal[axis]));
    };
    V enter = hn::Max(slab(ray.near_plane[0], 0), hn::Set(d, ray.tnear));
    V leave = hn::Min(slab(ray.far_plane[0], 0), hn::Set(d, tfar));
    for (int axis = 1; axis < 3; ++axis) {
      enter = hn::Max(slab(ray.near_plane[axis], axis), enter);
      leave = hn::Min(slab(ray.far_plane[axis], axis), leave);
    }
    const auto hit = hn::Le(enter, hn::Mul(leave, hn::Set(d, kFarFactor)));
    hn::Store(enter, d, distance + lane);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hit, bits);
    hits |= static_cast<std::uint32_t>(bits[0]) << lane;
  }
  return hits;
}

template <Movement kMovement>
HWY_INLINE std::uint32_t test_node(const NodeHeader& node, const RaySetup<kMovement>& ray, float tfar,
                                   float* distance) {
  constexpr bool kMoving = kMovement != Movement::kStill;
  const std::uint32_t level = kMoving ? node.level : 0;
  const SegmentTime at = kMoving ? ray.at_level[level] : SegmentTime{0, 0.0f};
  const std::uint32_t degree = kMovement == Movement::kPolynomial ? node.degree : 1;
  return test_boxes<kMovement, true>(node.bounds() + at.key * degree, kMoving && level != 0, degree, at, ray,
                                     tfar, distance);
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
