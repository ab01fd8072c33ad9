// A ray against a block of 4 triangles at the ray's time, watertight: S. Woop, C. Benthin, I. Wald,
// "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
//
// Woop recomputes edge functions in double where they are exactly 0 in single precision. Here they always
// have the exact sign: by Kahan's difference of products where there is a fused multiply-add (C.-P. Jeannerod
// et al., "Further analysis of Kahan's algorithm for the accurate computation of 2x2 determinants", Math.
// Comp. 82, 2013: error below 2 units in the last place), in double otherwise. A ray through a shared edge is
// then inside one of the two triangles or exactly on the edge, where both accept it.

#if defined(MSBVH_TRIANGLE_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_TRIANGLE_TEST_INL_H
#undef MSBVH_TRIANGLE_TEST_INL_H
#else
#define MSBVH_TRIANGLE_TEST_INL_H
#endif

#include <hwy/highway.h>

#include "core/bvh/bvh.h"
#include "core/trace/ray_setup-inl.h"
#include "core/trace/simd_lerp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D4 = hn::FixedTag<float, kBlockWidth>;
using V4 = hn::Vec<D4>;

// Positions of one vertex of each of the 4 triangles: [axis].
struct Vertex4 {
  V4 axis[3];
};

// a * b - c * d with the exact sign, 0 only if it is exactly 0 (short of underflow).
HWY_INLINE V4 difference_of_products(V4 a, V4 b, V4 c, V4 d) {
#if HWY_TARGET == HWY_SSE4
  const hn::FixedTag<double, 2> d64;
  const hn::FixedTag<float, 2> half;
  const auto in_double = [&](auto x, auto y, auto z, auto w) {
    return hn::DemoteTo(half, hn::Sub(hn::Mul(hn::PromoteTo(d64, x), hn::PromoteTo(d64, y)),
                                      hn::Mul(hn::PromoteTo(d64, z), hn::PromoteTo(d64, w))));
  };
  const D4 d4;
  const auto lo = in_double(hn::LowerHalf(a), hn::LowerHalf(b), hn::LowerHalf(c), hn::LowerHalf(d));
  const auto hi = in_double(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c),
                            hn::UpperHalf(half, d));
  return hn::Combine(d4, hi, lo);
#else
  const V4 cd = hn::Mul(c, d);
  const V4 error = hn::NegMulAdd(c, d, cd);  // cd - c * d, exactly
  return hn::Add(hn::MulSub(a, b, cd), error);
#endif
}

HWY_INLINE Vertex4 load_gathered(const GatheredKey& key, int vertex) {
  const D4 d;
  return {{hn::Load(d, key.position[vertex][0]), hn::Load(d, key.position[vertex][1]),
           hn::Load(d, key.position[vertex][2])}};
}

// Rows of 4 positions (x y z and a float that does not matter) to columns.
HWY_INLINE Vertex4 transpose(V4 a, V4 b, V4 c, V4 d) {
  const D4 tag;
  const V4 xy_ab = hn::InterleaveLower(tag, a, b), zw_ab = hn::InterleaveUpper(tag, a, b);
  const V4 xy_cd = hn::InterleaveLower(tag, c, d), zw_cd = hn::InterleaveUpper(tag, c, d);
  return {{hn::ConcatLowerLower(tag, xy_cd, xy_ab), hn::ConcatUpperUpper(tag, xy_cd, xy_ab),
           hn::ConcatLowerLower(tag, zw_cd, zw_ab)}};
}

template <Movement kMovement>
HWY_INLINE Vertex4 load_indexed(const Bvh& bvh, const BlockHeader& block, int vertex, SegmentTime at,
                                const Weights<D4>& w) {
  const D4 d;
  constexpr bool kMoving = kMovement != Movement::kStill;
  const std::uint32_t degree = kMovement == Movement::kPolynomial ? block.degree : 1;
  const auto& indices = reinterpret_cast<const VertexIndices*>(&block + 1)->vertex[vertex];
  V4 rows[kBlockWidth];
  for (std::uint32_t i = 0; i < kBlockWidth; ++i) {
    const TriangleMesh& mesh = *bvh.meshes[block.mesh[i]];
    const Vec3f* p = mesh.control_positions(at.key * degree) + indices[i];
    // The guard element makes the last one safe.
    const auto control = [&](std::uint32_t c) {
      return hn::LoadU(d, &p[std::size_t(c) * mesh.vertex_count].x);
    };
    rows[i] = kMoving && block.level != 0 ? simd_bezier(control, degree, w) : control(0);
  }
  return transpose(rows[0], rows[1], rows[2], rows[3]);
}

template <Movement kMovement>
HWY_INLINE Vertex4 load_vertex(const Bvh& bvh, const BlockHeader& block, int vertex, SegmentTime at,
                               const Weights<D4>& w) {
  constexpr bool kMoving = kMovement != Movement::kStill;
  if (kMoving && block.kind == BlockKind::kIndexed) return load_indexed<kMovement>(bvh, block, vertex, at, w);
  const std::uint32_t degree = kMovement == Movement::kPolynomial ? block.degree : 1;
  const auto* controls = reinterpret_cast<const GatheredKey*>(&block + 1) + at.key * degree;
  if (!kMoving || block.level == 0) return load_gathered(controls[0], vertex);
  Vertex4 v;
  for (int axis = 0; axis < 3; ++axis) {
    const auto control = [&](std::uint32_t c) { return hn::Load(D4(), controls[c].position[vertex][axis]); };
    v.axis[axis] = simd_bezier(control, degree, w);
  }
  return v;
}

// The vertex in the ray's space: origin at the ray's, the direction along z, unit z scale.
struct ShearedVertex {
  V4 x, y, z;
};

template <Movement kMovement>
HWY_INLINE ShearedVertex shear(const Vertex4& v, const RaySetup<kMovement>& ray) {
  const D4 d;
  const auto relative = [&](int axis) { return hn::Sub(v.axis[axis], hn::Set(d, ray.org[axis])); };
  const V4 z = relative(ray.kz);
  return {hn::NegMulAdd(hn::Set(d, ray.shear_x), z, relative(ray.kx)),
          hn::NegMulAdd(hn::Set(d, ray.shear_y), z, relative(ray.ky)), hn::Mul(hn::Set(d, ray.scale_z), z)};
}

struct BlockHit {
  std::uint32_t lanes;  // a bit for each triangle hit in [tnear, tfar]
  HWY_ALIGN float t[kBlockWidth], u[kBlockWidth], v[kBlockWidth];
};

template <Movement kMovement>
HWY_INLINE void test_block(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& ray,
                           float tfar, BlockHit& out) {
  const D4 d;
  const SegmentTime at = kMovement == Movement::kStill ? SegmentTime{0, 0.0f} : ray.at_level[block.level];
  const Weights<D4> w(d, at.w);
  const ShearedVertex a = shear(load_vertex<kMovement>(bvh, block, 0, at, w), ray);
  const ShearedVertex b = shear(load_vertex<kMovement>(bvh, block, 1, at, w), ray);
  const ShearedVertex c = shear(load_vertex<kMovement>(bvh, block, 2, at, w), ray);

  const V4 weight_a = difference_of_products(c.x, b.y, c.y, b.x);
  const V4 weight_b = difference_of_products(a.x, c.y, a.y, c.x);
  const V4 weight_c = difference_of_products(b.x, a.y, b.y, a.x);
  const V4 zero = hn::Zero(d);
  const V4 least = hn::Min(hn::Min(weight_a, weight_b), weight_c);
  const V4 most = hn::Max(hn::Max(weight_a, weight_b), weight_c);
  const V4 sum = hn::Add(hn::Add(weight_a, weight_b), weight_c);
  const auto inside = hn::And(hn::Or(hn::Ge(least, zero), hn::Le(most, zero)), hn::Ne(sum, zero));
  out.lanes = 0;
  if (hn::AllFalse(d, inside)) return;

  const V4 reciprocal = hn::Div(hn::Set(d, 1.0f), sum);
  const V4 t =
      hn::Mul(hn::MulAdd(weight_a, a.z, hn::MulAdd(weight_b, b.z, hn::Mul(weight_c, c.z))), reciprocal);
  const auto in_range = hn::And(hn::Ge(t, hn::Set(d, ray.tnear)), hn::Le(t, hn::Set(d, tfar)));
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, hn::And(inside, in_range), bits);
  out.lanes = bits[0] & ((1u << block.count) - 1u);
  hn::Store(t, d, out.t);
  hn::Store(hn::Mul(weight_b, reciprocal), d, out.u);
  hn::Store(hn::Mul(weight_c, reciprocal), d, out.v);
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
