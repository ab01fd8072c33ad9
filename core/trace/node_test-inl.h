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

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <hwy/highway.h>

#include "core/bvh/bvh.h"
#include "core/trace/ray_setup-inl.h"
#include "core/trace/simd_lerp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// 16 roundings of 2^-24: 8 each on the near and on the far distance.
constexpr float kFarFactor = 1.0f + 0x1p-20f;

// A child that is hit as an integer that orders like its distance, and carries the child's slot in the three
// lowest bits: distances are not negative. That makes a distance at most 7 units in the last place less,
// which is on the safe side. A child that is not hit is kNoChild, farther than any.
using ChildKey = std::int32_t;
inline constexpr ChildKey kNoChild = 0x7fffffff;
inline constexpr ChildKey kSlotMask = kWidth - 1;
HWY_INLINE float distance_of(ChildKey key) { return std::bit_cast<float>(key & ~kSlotMask); }

// Whether nothing in a box that is entered there can be nearer than, or as near as, what was found at `tfar`:
// by the same roundings, so that of things at one distance all are looked at, in whatever order boxes come.
HWY_INLINE bool is_beyond(float enter, float tfar) { return enter > tfar * kFarFactor; }

// The keys of a node's children, in as many vectors as the instruction set needs for 8.
class ChildKeys {
 public:
  using D = hn::CappedTag<ChildKey, kWidth>;
  using V = hn::Vec<D>;
  static constexpr std::size_t kLanes = hn::MaxLanes(D());
  static constexpr std::size_t kVectors = kWidth / kLanes;

  V vector[kVectors];

  HWY_INLINE static std::uint32_t slot(ChildKey key) { return static_cast<std::uint32_t>(key & kSlotMask); }

  HWY_INLINE static ChildKeys load(const ChildKey* keys) {
    ChildKeys k;
    for (std::size_t i = 0; i < kVectors; ++i) k.vector[i] = hn::Load(D(), keys + i * kLanes);
    return k;
  }
  HWY_INLINE void store(ChildKey* keys) const {
    for (std::size_t i = 0; i < kVectors; ++i) hn::Store(vector[i], D(), keys + i * kLanes);
  }
  // The nearest child's key; the keys of the others are stored. No branch depends on their number.
  HWY_INLINE ChildKey take_nearest(ChildKey* others) const {
    const D d;
    V least = vector[0];
    for (std::size_t i = 1; i < kVectors; ++i) least = hn::Min(least, vector[i]);
    least = hn::MinOfLanes(d, least);
    for (std::size_t i = 0; i < kVectors; ++i)
      hn::Store(hn::IfThenElse(hn::Eq(vector[i], least), hn::Set(d, kNoChild), vector[i]), d,
                others + i * kLanes);
    return hn::GetLane(least);
  }
};

// How a node's planes are read, from the first control in force on: floats, or 16 bits in the node's frame.
HWY_INLINE const float* first_of(const float* planes) { return planes; }
template <class D>
HWY_INLINE hn::Vec<D> load_planes(D d, const float*, const float* at, std::size_t) {
  return hn::Load(d, at);
}
template <class M>
HWY_INLINE M present(const float*, M hit, std::size_t) {
  return hit;
}

// As NodeFrame::plane(): the product is exact, fused or not.
struct CompactPlanes {
  const std::uint16_t* first;
  const NodeHeader& node;

  template <class D>
  HWY_INLINE hn::Vec<D> load(D d, const std::uint16_t* at, std::size_t axis) const {
    const hn::Rebind<std::int32_t, D> di;
    const auto q = hn::PromoteTo(di, hn::LoadU(hn::Rebind<std::uint16_t, D>(), at));
    return hn::MulAdd(hn::ConvertTo(d, q), scale(d, axis), hn::Set(d, node.frame.origin[axis]));
  }
  // As NodeFrame::scale(): the exponents are read together, and each is shifted to its place in a float.
  template <class D>
  HWY_INLINE hn::Vec<D> scale(D d, std::size_t axis) const {
    const hn::Rebind<std::int32_t, D> di;
    std::int32_t exponents;
    static_assert(sizeof(NodeFrame) == offsetof(NodeFrame, exponent) + sizeof(exponents));
    std::memcpy(&exponents, reinterpret_cast<const std::byte*>(&node.frame) + offsetof(NodeFrame, exponent),
                sizeof(exponents));
    const auto shifted = hn::ShiftLeftSame(hn::Set(di, exponents), static_cast<int>(23 - 8 * axis));
    return hn::BitCast(d, hn::And(shifted, hn::Set(di, 0x7f800000)));
  }
  // Absent children's boxes are not such that no ray hits them.
  template <class M>
  HWY_INLINE M present(M hit, std::size_t lane) const {
    const hn::CappedTag<float, kWidth> d;
    const hn::RebindToSigned<decltype(d)> di;
    const auto there = hn::Lt(hn::Iota(di, static_cast<std::int32_t>(lane)),
                              hn::Set(di, static_cast<std::int32_t>(node.child_count)));
    return hn::And(hit, hn::RebindMask(d, there));
  }
};
HWY_INLINE const std::uint16_t* first_of(CompactPlanes planes) { return planes.first; }
template <class D>
HWY_INLINE hn::Vec<D> load_planes(D d, CompactPlanes planes, const std::uint16_t* at, std::size_t axis) {
  return planes.load(d, at, axis);
}
template <class M>
HWY_INLINE M present(CompactPlanes planes, M hit, std::size_t lane) {
  return planes.present(hit, lane);
}
static_assert(sizeof(NodeBounds) / sizeof(float) == sizeof(CompactBounds) / sizeof(std::uint16_t));

// What a ray meets of the 8 boxes: the distances where it enters and where it leaves them.
//
// A direction of 0 makes the reciprocal infinite and 0 * inf a NaN when the origin lies exactly on a plane.
// x86's max and min return their second operand then: the plane bounds nothing, and the box counts as
// entered.
#if HWY_TARGET == HWY_AVX3
// Both sides of 8 boxes fill a vector: lower sides as they are, upper ones negated, so that one maximum over
// the axes gives where the boxes are entered and, negated, where they are left.
template <Movement kMovement>
class Slabs {
  static constexpr bool kMoving = kMovement != Movement::kStill;

 public:
  template <class Planes>
  HWY_INLINE Slabs(Planes planes, std::size_t stride, std::uint32_t degree, float w,
                   const RaySetup<kMovement>& ray, float tfar) {
    const hn::FixedTag<float, 2 * kWidth> d;
    const Weights<decltype(d)> weights(d, w);
    auto farthest = hn::IfThenElse(hn::FirstN(d, kWidth), hn::Set(d, ray.tnear), hn::Set(d, -tfar));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto* p = first_of(planes) + 2 * kWidth * axis;
      const auto control = [&](std::uint32_t c) { return load_planes(d, planes, p + c * stride, axis); };
      const auto x = kMoving ? simd_bezier(control, degree, weights) : control(0);
      const auto t = hn::Mul(hn::Sub(x, hn::Set(d, ray.org[axis])), hn::Load(d, ray.signed_reciprocal[axis]));
      const auto swap = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&ray.backwards[axis]));
      farthest = hn::Max(hn::IfThenElse(swap, hn::ConcatLowerUpper(d, t, t), t), farthest);
    }
    enter_ = hn::LowerHalf(farthest);
    leave_ = hn::UpperHalf(hn::Half<decltype(d)>(), farthest);
  }
  HWY_INLINE auto enter(std::size_t) const { return enter_; }
  HWY_INLINE auto hit(std::size_t) const {
    return hn::Le(enter_, hn::Mul(leave_, hn::Set(hn::FixedTag<float, kWidth>(), -kFarFactor)));
  }

 private:
  hn::Vec<hn::FixedTag<float, kWidth>> enter_, leave_;
};
#else
template <Movement kMovement>
class Slabs {
  static constexpr bool kMoving = kMovement != Movement::kStill;

 public:
  template <class Planes>
  HWY_INLINE Slabs(Planes planes, std::size_t stride, std::uint32_t degree, float w,
                   const RaySetup<kMovement>& ray, float tfar) {
    const D d;
    const Weights<D> weights(d, w);
    for (std::size_t i = 0; i < ChildKeys::kVectors; ++i) {
      const auto slab = [&](std::uint32_t plane, int axis) {
        const auto* p = first_of(planes) + plane + i * ChildKeys::kLanes;
        const auto control = [&](std::uint32_t c) {
          return load_planes(d, planes, p + c * stride, static_cast<std::size_t>(axis));
        };
        const auto x = kMoving ? simd_bezier(control, degree, weights) : control(0);
        return hn::Mul(hn::Sub(x, hn::Set(d, ray.org[axis])), hn::Set(d, ray.reciprocal[axis]));
      };
      enter_[i] = hn::Max(slab(ray.near_plane[0], 0), hn::Set(d, ray.tnear));
      leave_[i] = hn::Min(slab(ray.far_plane[0], 0), hn::Set(d, tfar));
      for (int axis = 1; axis < 3; ++axis) {
        enter_[i] = hn::Max(slab(ray.near_plane[axis], axis), enter_[i]);
        leave_[i] = hn::Min(slab(ray.far_plane[axis], axis), leave_[i]);
      }
    }
  }
  HWY_INLINE auto enter(std::size_t i) const { return enter_[i]; }
  HWY_INLINE auto hit(std::size_t i) const {
    return hn::Le(enter_[i], hn::Mul(leave_[i], hn::Set(D(), kFarFactor)));
  }

 private:
  using D = hn::CappedTag<float, kWidth>;
  hn::Vec<D> enter_[ChildKeys::kVectors], leave_[ChildKeys::kVectors];
};
#endif

// The keys of 8 boxes; `hits` gets a bit for each that is hit in [tnear, tfar]. `planes` begin at the first
// control in force at the ray's time, w is the time's weight there.
template <Movement kMovement, class Planes>
HWY_INLINE ChildKeys test_planes(Planes planes, bool moves, std::uint32_t degree, float w,
                                 const RaySetup<kMovement>& ray, float tfar, std::uint32_t& hits) {
  const hn::CappedTag<float, kWidth> d;
  const ChildKeys::D di;
  // Among moving boxes a still one is one whose next control is itself, with weight 0: (1 - 0) x + 0 x is x,
  // and no branch has to guess which is which.
  const std::size_t stride = std::size_t(moves) * (sizeof(NodeBounds) / sizeof(float));
  const Slabs<kMovement> slabs(planes, stride, degree, w, ray, tfar);
  ChildKeys keys;
  hits = 0;
  for (std::size_t i = 0; i < ChildKeys::kVectors; ++i) {
    const std::size_t lane = i * ChildKeys::kLanes;
    const auto hit = present(planes, slabs.hit(i), lane);
    const auto key = hn::Or(hn::AndNot(hn::Set(di, kSlotMask), hn::BitCast(di, slabs.enter(i))),
                            hn::Iota(di, static_cast<ChildKey>(lane)));
    keys.vector[i] = hn::IfThenElse(hn::RebindMask(di, hit), key, hn::Set(di, kNoChild));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hit, bits);
    hits |= static_cast<std::uint32_t>(bits[0]) << lane;
  }
  return keys;
}

template <Movement kMovement>
HWY_INLINE ChildKeys test_boxes(const NodeBounds* first, bool moves, std::uint32_t degree, float w,
                                const RaySetup<kMovement>& ray, float tfar, std::uint32_t& hits) {
  return test_planes<kMovement>(reinterpret_cast<const float*>(first), moves, degree, w, ray, tfar, hits);
}

// Of a node's children; `bounds` as in force at the ray's time.
template <Movement kMovement>
HWY_INLINE ChildKeys test_children(const NodeBounds* bounds, FormCode form, const RaySetup<kMovement>& ray,
                                   float tfar, std::uint32_t& hits) {
  const std::uint32_t level = kMovement != Movement::kStill ? form.level() : 0;
  const std::uint32_t degree = kMovement == Movement::kPolynomial ? form.degree() : 1;
  return test_boxes<kMovement>(bounds, level != 0, degree, ray.at_level[level].w, ray, tfar, hits);
}
template <Movement kMovement>
HWY_INLINE ChildKeys test_children(const CompactBounds* bounds, const NodeHeader& node, FormCode form,
                                   const RaySetup<kMovement>& ray, float tfar, std::uint32_t& hits) {
  const std::uint32_t level = kMovement != Movement::kStill ? form.level() : 0;
  const std::uint32_t degree = kMovement == Movement::kPolynomial ? form.degree() : 1;
  const CompactPlanes planes{reinterpret_cast<const std::uint16_t*>(bounds), node};
  return test_planes<kMovement>(planes, level != 0, degree, ray.at_level[level].w, ray, tfar, hits);
}
template <Movement kMovement, bool kCompact>
HWY_INLINE ChildKeys test_node(const NodeHeader& node, FormCode form, const RaySetup<kMovement>& ray,
                               float tfar, std::uint32_t& hits) {
  const std::uint32_t key = kMovement != Movement::kStill ? ray.at_level[form.level()].key : 0;
  const std::uint32_t degree = kMovement == Movement::kPolynomial ? form.degree() : 1;
  if constexpr (kCompact)
    return test_children<kMovement>(node.compact_bounds() + key * degree, node, form, ray, tfar, hits);
  else
    return test_children<kMovement>(node.bounds() + key * degree, form, ray, tfar, hits);
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
