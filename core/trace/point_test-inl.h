// A ray against up to 8 spheres: E. Haines, J. Guenther, T. Akenine-Moeller, "Precision Improvements for
// Ray/Sphere Intersection", Ray Tracing Gems, chapter 7: the distance of the centre from the ray is taken as
// the length of a vector, not as a difference of squares, so that small spheres far away keep their digits.

#if defined(MSBVH_POINT_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_POINT_TEST_INL_H
#undef MSBVH_POINT_TEST_INL_H
#else
#define MSBVH_POINT_TEST_INL_H
#endif

#include <bit>
#include <cstdint>
#include <hwy/highway.h>

#include "core/trace/round_test-inl.h"
#include "core/trace/triangle_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A bit in `hit.lanes` for each of the block's points that is hit in [tnear, tfar], and where.
template <Movement kMovement>
HWY_INLINE void test_spheres(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& setup,
                             float tfar, BlockHit& hit) {
  const hn::CappedTag<float, kBlockWidth> d;
  const PointSet& points = *bvh.points[block.owner];
  const VerticesAtTime<kMovement> vertices(points.vertices.data(), points.point_count, block.form_code,
                                           setup);
  alignas(64) float row[4][kBlockWidth];
  for (std::uint32_t i = 0; i < kBlockWidth; ++i) {
    alignas(16) float v[4];
    hn::Store(vertices[block.triangles()[i < block.lanes() ? i : 0]], D4f(), v);
    for (int k = 0; k < 4; ++k) row[k][i] = v[k];
  }
  const RayFrame frame(direction_of(setup));
  hit.lanes = 0;
  for (std::uint32_t lane = 0; lane < kBlockWidth; lane += hn::Lanes(d)) {
    const auto from = [&](int axis) {
      return hn::Sub(hn::Load(d, row[axis] + lane), hn::Set(d, setup.org[axis]));
    };
    const auto x = from(0), y = from(1), z = from(2), r = hn::Load(d, row[3] + lane);
    const auto dot3 = [&](const Vec3f& v) {
      return hn::MulAdd(z, hn::Set(d, v.z), hn::MulAdd(y, hn::Set(d, v.y), hn::Mul(x, hn::Set(d, v.x))));
    };
    const auto along = dot3(frame.z), a = dot3(frame.x), b = dot3(frame.y);
    const auto rest = hn::NegMulAdd(a, a, hn::NegMulAdd(b, b, hn::Mul(r, r)));
    const auto half = hn::Sqrt(hn::Max(rest, hn::Zero(d)));
    const auto scale = hn::Set(d, frame.inverse_length), tnear = hn::Set(d, setup.tnear);
    const auto near = hn::Mul(hn::Sub(along, half), scale), far = hn::Mul(hn::Add(along, half), scale);
    const auto t = hn::IfThenElse(hn::Ge(near, tnear), near, far);
    const auto met = hn::And(hn::And(hn::Ge(rest, hn::Zero(d)), hn::Gt(r, hn::Zero(d))),
                             hn::And(hn::Ge(t, tnear), hn::Le(t, hn::Set(d, tfar))));
    hn::Store(t, d, hit.t + lane);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, met, bits);
    hit.lanes |= static_cast<std::uint32_t>(bits[0]) << lane;
  }
  hit.lanes &= (1u << block.count) - 1u;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
