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

// A bit in `hit.lanes` for each of the block's points that is hit in [tnear, tfar], and where. Along the ray
// goes its shear (ray_setup-inl.h): a direction whose largest coordinate is 1, so that no square of it is
// lost.
template <Movement kMovement>
HWY_INLINE void test_spheres(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& setup,
                             float tfar, BlockHit& hit) {
  const hn::CappedTag<float, kBlockWidth> d;
  const PointSet& points = *bvh.points[block.owner];
  const VerticesAtTime<kMovement> vertices(points.vertices.data(), points.point_count, block.form_code,
                                           setup);
  alignas(64) float vertex[kBlockWidth][4];
  for (std::uint32_t i = 0; i < kBlockWidth; ++i)
    hn::Store(vertices[block.triangles()[i < block.lanes() ? i : 0]], D4f(), vertex[i]);
  const Vec3f along = sheared_direction(setup);
  const auto dx = hn::Set(d, along.x), dy = hn::Set(d, along.y), dz = hn::Set(d, along.z);
  const auto inverse2 = hn::Set(d, 1.0f / dot(along, along));
  const auto scale = hn::Set(d, setup.shear.scale_z), tnear = hn::Set(d, setup.tnear);
  hit.lanes = 0;
  for (std::uint32_t lane = 0; lane < kBlockWidth; lane += hn::Lanes(d)) {
    auto x = hn::Zero(d), y = x, z = x, r = x;
    hn::LoadInterleaved4(d, vertex[lane], x, y, z, r);
    x = hn::Sub(x, hn::Set(d, setup.org[0]));
    y = hn::Sub(y, hn::Set(d, setup.org[1]));
    z = hn::Sub(z, hn::Set(d, setup.org[2]));
    const auto foot = hn::Mul(dot_lanes(d, along, x, y, z), inverse2);
    x = hn::NegMulAdd(foot, dx, x), y = hn::NegMulAdd(foot, dy, y), z = hn::NegMulAdd(foot, dz, z);
    const auto rest = hn::NegMulAdd(x, x, hn::NegMulAdd(y, y, hn::NegMulAdd(z, z, hn::Mul(r, r))));
    const auto half = hn::Mul(hn::Sqrt(hn::Mul(hn::Max(rest, hn::Zero(d)), inverse2)), hn::Abs(scale));
    const auto near = hn::MulSub(foot, scale, half), far = hn::MulAdd(foot, scale, half);
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
