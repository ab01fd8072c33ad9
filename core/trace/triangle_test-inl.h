// A ray against a block of triangles at the ray's time, watertight: S. Woop, C. Benthin, I. Wald,
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

#include <algorithm>
#include <hwy/highway.h>

#include "core/bvh/bvh.h"
#include "core/trace/ray_setup-inl.h"
#include "core/trace/simd_lerp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D4 = hn::FixedTag<float, 4>;
using V4 = hn::Vec<D4>;
// As many triangles at once as the instruction set can, at most a block's; and vertices.
using D8 = hn::CappedTag<float, kBlockWidth>;
using V8 = hn::Vec<D8>;
#if HWY_TARGET == HWY_AVX3
using DPool = hn::FixedTag<float, kBlockVertices>;
#else
using DPool = D8;
#endif
using VPool = hn::Vec<DPool>;
inline constexpr std::uint32_t kLanes8 = hn::MaxLanes(D8());
inline constexpr std::uint32_t kPoolLanes = hn::MaxLanes(DPool());

// a * b - c * d with the exact sign, 0 only if it is exactly 0 (short of underflow).
HWY_INLINE V8 difference_of_products(V8 a, V8 b, V8 c, V8 d) {
#if HWY_TARGET == HWY_SSE4
  const hn::FixedTag<double, 2> d64;
  const hn::FixedTag<float, 2> half;
  const auto in_double = [&](auto x, auto y, auto z, auto w) {
    return hn::DemoteTo(half, hn::Sub(hn::Mul(hn::PromoteTo(d64, x), hn::PromoteTo(d64, y)),
                                      hn::Mul(hn::PromoteTo(d64, z), hn::PromoteTo(d64, w))));
  };
  const auto lo = in_double(hn::LowerHalf(a), hn::LowerHalf(b), hn::LowerHalf(c), hn::LowerHalf(d));
  const auto hi = in_double(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c),
                            hn::UpperHalf(half, d));
  return hn::Combine(D8(), hi, lo);
#else
  const V8 cd = hn::Mul(c, d);
  const V8 error = hn::NegMulAdd(c, d, cd);  // cd - c * d, exactly
  return hn::Add(hn::MulSub(a, b, cd), error);
#endif
}

// Positions in the ray's space, its origin at the ray's, the direction along z, unit z scale: of several
// vertices, or of the same corner of several triangles.
template <typename V>
struct Sheared {
  V x, y, z;
};

// How a tree's triangle blocks hold their vertices (BlockKind), as far as kernels are compiled for it. Still
// kernels know no indices, but those of compact trees, which have no other blocks.
enum class BlockForms { kGathered, kEither, kIndexed };
template <Movement kMovement, bool kCompact>
inline constexpr BlockForms kBlockForms = kCompact                        ? BlockForms::kIndexed
                                          : kMovement == Movement::kStill ? BlockForms::kGathered
                                                                          : BlockForms::kEither;

// A block's vertices at the ray's time.
template <Movement kMovement, BlockForms kForms>
class BlockVertices {
 public:
  HWY_INLINE BlockVertices(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& ray)
      : block_(block),
        ray_(ray),
        at_(ray.at_level[block.form_code.level()]),
        degree_(kMovement == Movement::kPolynomial ? block.form_code.degree() : 1),
        moves_(kMoving && block.form_code.level() != 0),
        bvh_(bvh) {}

  // Those from `first` on, as many as fit a vector.
  HWY_INLINE Sheared<VPool> sheared(std::uint32_t first) const {
    if constexpr (kForms == BlockForms::kIndexed) {
      HWY_ALIGN float columns[3][kPoolLanes];
      load_columns(first, columns);
      return shear([&](std::int32_t axis) { return hn::Load(DPool(), columns[axis]); });
    }
    if (kForms == BlockForms::kEither && block_.kind == BlockKind::kIndexed) {
      HWY_ALIGN float columns[3][kPoolLanes];
      load_indexed(first, columns);
      return shear([&](std::int32_t axis) { return hn::Load(DPool(), columns[axis]); });
    }
    return shear([&](std::int32_t axis) { return gathered(first, axis); });
  }

 private:
  static constexpr bool kMoving = kMovement != Movement::kStill;

  // `coordinate(axis)`: of all vertices.
  template <class Coordinate>
  HWY_INLINE Sheared<VPool> shear(const Coordinate& coordinate) const {
    const DPool d;
    const auto relative = [&](std::int32_t axis) {
      return hn::Sub(coordinate(axis), hn::Set(d, ray_.org[axis]));
    };
    const VPool z = relative(ray_.axes.z);
    return {hn::NegMulAdd(hn::Set(d, ray_.shear.x), z, relative(ray_.axes.x)),
            hn::NegMulAdd(hn::Set(d, ray_.shear.y), z, relative(ray_.axes.y)),
            hn::Mul(hn::Set(d, ray_.shear.scale_z), z)};
  }

  HWY_INLINE VPool gathered(std::uint32_t first, std::int32_t axis) const {
    const std::size_t row = block_.row_floats();
    const float* p =
        block_.vertices() + row * (3 * at_.key * degree_ + static_cast<std::uint32_t>(axis)) + first;
    const std::size_t stride = std::size_t(moves_) * 3 * row;  // as of a node: node_test-inl.h
    const auto control = [&](std::uint32_t c) { return load_row(p + c * stride, row); };
    return kMoving ? simd_bezier(control, degree_, Weights<DPool>(DPool(), at_.w)) : control(0);
  }

  // What follows a row may be anything. Read as floats, ids are denormal numbers, which take long to
  // multiply.
  HWY_INLINE static VPool load_row(const float* p, [[maybe_unused]] std::size_t row) {
    const DPool d;
#if HWY_TARGET == HWY_AVX3
    return hn::MaskedLoad(hn::FirstN(d, row), d, p);
#else
    return hn::LoadU(d, p);
#endif
  }

  // A vertex's three coordinates at once, then rows to columns, four vertices by four.
  HWY_INLINE void load_indexed(std::uint32_t first, float (&columns)[3][kPoolLanes]) const {
    const D4 d;
    const TriangleMesh& mesh = *bvh_.meshes[block_.owner];
    const std::uint32_t* indices = block_.vertex_indices() + first;
    const std::uint32_t count = std::min(block_.row_floats() - first, kPoolLanes);
    for (std::uint32_t i = 0; i < count; i += 4) {
      const V4 a = position(mesh, indices[i]), b = position(mesh, indices[i + 1]),
               c = position(mesh, indices[i + 2]), e = position(mesh, indices[i + 3]);
      const V4 xy_ab = hn::InterleaveLower(d, a, b), zw_ab = hn::InterleaveUpper(d, a, b);
      const V4 xy_ce = hn::InterleaveLower(d, c, e), zw_ce = hn::InterleaveUpper(d, c, e);
      hn::Store(hn::ConcatLowerLower(d, xy_ce, xy_ab), d, columns[0] + i);
      hn::Store(hn::ConcatUpperUpper(d, xy_ce, xy_ab), d, columns[1] + i);
      hn::Store(hn::ConcatLowerLower(d, zw_ce, zw_ab), d, columns[2] + i);
    }
  }
  HWY_INLINE V4 position(const TriangleMesh& mesh, std::uint32_t vertex) const {
    const D4 d;
    const Vec3f* p = mesh.control_positions(at_.key * degree_) + vertex;
    // The guard element makes the last one safe.
    const auto control = [&](std::uint32_t c) {
      return hn::LoadU(d, &p[std::size_t(c) * mesh.vertex_count].x);
    };
    return moves_ ? simd_bezier(control, degree_, Weights<D4>(d, at_.w)) : control(0);
  }

  // The same for kernels that know no other blocks, with fewer instructions; beside gathered ones it would
  // take the registers that those need. Stored as whole vectors: what is read back wider waits for the
  // stores.
  HWY_INLINE void load_columns(std::uint32_t first, float (&columns)[3][kPoolLanes]) const {
    const std::uint32_t* indices = block_.vertex_indices() + first;
    const std::uint32_t count = block_.row_floats() - first;
    V8 low[3];
    transpose(indices, count, low);
#if HWY_TARGET == HWY_AVX3
    V8 high[3] = {low[0], low[1], low[2]};
    if (count > kLanes8) transpose(indices + kLanes8, count - kLanes8, high);
    for (int axis = 0; axis < 3; ++axis)
      hn::Store(hn::Combine(DPool(), high[axis], low[axis]), DPool(), columns[axis]);
#else
    for (int axis = 0; axis < 3; ++axis) hn::Store(low[axis], D8(), columns[axis]);
#endif
  }
  // A vertex's three coordinates at once, then rows to columns, of four vertices in each block of a vector.
  // `count`: how many indices there are, 4 at least; what is beyond repeats the first ones.
  HWY_INLINE void transpose(const std::uint32_t* indices, std::uint32_t count, V8 (&columns)[3]) const {
    const D8 d;
    const hn::Repartition<double, D8> pairs;
    const Track track = track_of(*bvh_.meshes[block_.owner]);
    const std::uint32_t* upper = indices + (count > 4 ? 4 : 0);
    const auto vertex = [&](std::uint32_t i) { return positions(track, indices[i], upper[i]); };
    const V8 a = vertex(0), b = vertex(1), c = vertex(2), e = vertex(3);
    const auto xy_ab = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto xy_ce = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
    const auto zw_ab = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    const auto zw_ce = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
    columns[0] = hn::BitCast(d, hn::InterleaveLower(pairs, xy_ab, xy_ce));
    columns[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, xy_ab, xy_ce));
    columns[2] = hn::BitCast(d, hn::InterleaveLower(pairs, zw_ab, zw_ce));
  }

  // The controls in force, of all of a mesh's vertices.
  struct Track {
    const Vec3f* first;
    std::size_t stride;  // 0 of what does not move: as of a node, node_test-inl.h
  };
  HWY_INLINE Track track_of(const TriangleMesh& mesh) const {
    return {mesh.control_positions(at_.key * degree_), moves_ ? std::size_t(mesh.vertex_count) : 0};
  }
  // Of one vertex in each block of 4 lanes; the guard element makes the last one safe.
  HWY_INLINE V8 positions(const Track& track, std::uint32_t lower,
                          [[maybe_unused]] std::uint32_t upper) const {
    const auto control = [&](std::uint32_t c) {
      const Vec3f* p = track.first + c * track.stride;
#if HWY_TARGET == HWY_SSE4
      return hn::LoadU(D8(), &p[lower].x);
#else
      return hn::Combine(D8(), hn::LoadU(D4(), &p[upper].x), hn::LoadU(D4(), &p[lower].x));
#endif
    };
    return kMoving ? simd_bezier(control, degree_, Weights<D8>(D8(), at_.w)) : control(0);
  }

  const BlockHeader& block_;
  const RaySetup<kMovement>& ray_;
  const SegmentTime at_;
  const std::uint32_t degree_;
  const bool moves_;
  const Bvh& bvh_;
};

// A block's vertices where the corners of its triangles pick them.
class VertexPool {
 public:
#if HWY_TARGET == HWY_SSE4  // through memory
  template <class Vertices>
  HWY_INLINE VertexPool(const Vertices& vertices, std::uint32_t count) {
    const D8 d;
    for (std::uint32_t first = 0; first < count; first += kLanes8) {
      const Sheared<V8> s = vertices.sheared(first);
      hn::Store(s.x, d, x_ + first);
      hn::Store(s.y, d, y_ + first);
      hn::Store(s.z, d, z_ + first);
    }
  }
  HWY_INLINE Sheared<V8> pick(const std::uint8_t* corners) const {
    return {of(x_, corners), of(y_, corners), of(z_, corners)};
  }

 private:
  HWY_INLINE static V8 of(const float* row, const std::uint8_t* corners) {
    HWY_ALIGN const float picked[4] = {row[corners[0]], row[corners[1]], row[corners[2]], row[corners[3]]};
    return hn::Load(D8(), picked);
  }
  HWY_ALIGN float x_[kBlockVertices];
  HWY_ALIGN float y_[kBlockVertices];
  HWY_ALIGN float z_[kBlockVertices];
#elif HWY_TARGET == HWY_AVX2  // from one or two registers
  template <class Vertices>
  HWY_INLINE VertexPool(const Vertices& vertices, std::uint32_t count)
      : many_(count > kPoolLanes),
        low_(vertices.sheared(0)),
        high_(many_ ? vertices.sheared(kPoolLanes) : low_) {}

  HWY_INLINE Sheared<V8> pick(const std::uint8_t* corners) const {
    const D8 d;
    const hn::RebindToSigned<D8> di;
    const auto at = hn::PromoteTo(di, hn::LoadU(hn::Rebind<std::uint8_t, D8>(), corners));
    const auto lane = hn::IndicesFromVec(d, hn::And(at, hn::Set(di, kPoolLanes - 1)));
    const auto beyond = hn::RebindMask(d, hn::Gt(at, hn::Set(di, kPoolLanes - 1)));
    const auto of = [&](V8 low, V8 high) {
      const V8 v = hn::TableLookupLanes(low, lane);
      return many_ ? hn::IfThenElse(beyond, hn::TableLookupLanes(high, lane), v) : v;
    };
    return {of(low_.x, high_.x), of(low_.y, high_.y), of(low_.z, high_.z)};
  }

 private:
  const bool many_;
  const Sheared<V8> low_, high_;
#else                         // from one register
  template <class Vertices>
  HWY_INLINE VertexPool(const Vertices& vertices, std::uint32_t) : vertices_(vertices.sheared(0)) {}

  HWY_INLINE Sheared<V8> pick(const std::uint8_t* corners) const {
    const DPool d;
    const hn::RebindToSigned<DPool> di;
    const auto at = hn::PromoteTo(di, hn::LoadU(hn::Rebind<std::uint8_t, DPool>(), corners));
    // 8 corners are read as 16: the others are no corners, and not used.
    const auto lane = hn::IndicesFromVec(d, hn::And(at, hn::Set(di, kPoolLanes - 1)));
    const auto of = [&](VPool v) { return hn::LowerHalf(hn::TableLookupLanes(v, lane)); };
    return {of(vertices_.x), of(vertices_.y), of(vertices_.z)};
  }

 private:
  const Sheared<VPool> vertices_;
#endif
};

struct BlockHit {
  std::uint32_t lanes;  // a bit for each triangle hit in [tnear, tfar]
  HWY_ALIGN float t[kBlockWidth], u[kBlockWidth], v[kBlockWidth];
};

// As many triangles as fit a vector, by their corners. What is found goes into `out` from `first` on.
HWY_INLINE std::uint32_t test_corners(const Sheared<V8>& a, const Sheared<V8>& b, const Sheared<V8>& c,
                                      float tnear, float tfar, std::uint32_t first, BlockHit& out) {
  const D8 d;
  const V8 weight_a = difference_of_products(c.x, b.y, c.y, b.x);
  const V8 weight_b = difference_of_products(a.x, c.y, a.y, c.x);
  const V8 weight_c = difference_of_products(b.x, a.y, b.y, a.x);
  const V8 zero = hn::Zero(d);
  const V8 least = hn::Min(hn::Min(weight_a, weight_b), weight_c);
  const V8 most = hn::Max(hn::Max(weight_a, weight_b), weight_c);
  const V8 sum = hn::Add(hn::Add(weight_a, weight_b), weight_c);
  const auto inside = hn::And(hn::Or(hn::Ge(least, zero), hn::Le(most, zero)), hn::Ne(sum, zero));
  if (hn::AllFalse(d, inside)) return 0;

  // Divided first: a weight times a distance has the third power of coordinates in it, which may overflow.
  const V8 reciprocal = hn::Div(hn::Set(d, 1.0f), sum);
  const V8 u = hn::Mul(weight_b, reciprocal), v = hn::Mul(weight_c, reciprocal);
  const V8 t = hn::MulAdd(hn::Mul(weight_a, reciprocal), a.z, hn::MulAdd(u, b.z, hn::Mul(v, c.z)));
  const auto in_range = hn::And(hn::Ge(t, hn::Set(d, tnear)), hn::Le(t, hn::Set(d, tfar)));
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, hn::And(inside, in_range), bits);
  hn::Store(t, d, out.t + first);
  hn::Store(u, d, out.u + first);
  hn::Store(v, d, out.v + first);
  return static_cast<std::uint32_t>(bits[0]) << first;
}

// The triangles from `first` on, as many as fit a vector.
HWY_INLINE std::uint32_t test_triangles(const VertexPool& pool, const BlockHeader& block, std::uint32_t first,
                                        float tnear, float tfar, BlockHit& out) {
  const Sheared<V8> a = pool.pick(block.corners(0) + first);
  const Sheared<V8> b = pool.pick(block.corners(1) + first);
  const Sheared<V8> c = pool.pick(block.corners(2) + first);
  return test_corners(a, b, c, tnear, tfar, first, out);
}

template <Movement kMovement, bool kCompact>
HWY_INLINE void test_block(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& ray,
                           float tfar, BlockHit& out) {
  const VertexPool pool(BlockVertices<kMovement, kBlockForms<kMovement, kCompact>>(bvh, block, ray),
                        block.vertex_count);
  out.lanes = test_triangles(pool, block, 0, ray.tnear, tfar, out);
  if (kLanes8 < kBlockWidth && block.count > kLanes8)
    out.lanes |= test_triangles(pool, block, kLanes8, ray.tnear, tfar, out);
  out.lanes &= (1u << block.count) - 1u;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
