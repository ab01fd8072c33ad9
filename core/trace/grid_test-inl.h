// A ray against a window of a grid at the ray's time: first the boxes of its tiles, then the quads of the
// tiles that are hit, two triangles each, by the test of triangle_test-inl.h in the same arithmetic. Points
// of neighbouring quads, tiles, windows and grids are the same bits, interpolated and sheared by the same
// operations, and edge functions have exact signs: a ray through a shared edge hits at least one of its
// triangles (Woop et al. 2013).

#if defined(MSBVH_GRID_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_GRID_TEST_INL_H
#undef MSBVH_GRID_TEST_INL_H
#else
#define MSBVH_GRID_TEST_INL_H
#endif

#include <algorithm>
#include <hwy/highway.h>

#include "core/bvh/grid_block.h"
#include "core/trace/node_test-inl.h"
#include "core/trace/ray_setup-inl.h"
#include "core/trace/simd_lerp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// 8 quads of a tile at once, or its two rows of 4 one after the other.
using TileTag = hn::CappedTag<float, kTileRows * kTileColumns>;
using TileVec = hn::Vec<TileTag>;
inline constexpr std::size_t kTileLanes = kTileRows * kTileColumns;

// a * b - c * d with the exact sign; see difference_of_products() in triangle_test-inl.h, for any number of
// lanes.
HWY_INLINE TileVec edge_function(TileVec a, TileVec b, TileVec c, TileVec d) {
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
  return hn::Combine(TileTag(), hi, lo);
#else
  const TileVec cd = hn::Mul(c, d);
  const TileVec error = hn::NegMulAdd(c, d, cd);  // cd - c * d, exactly
  return hn::Add(hn::MulSub(a, b, cd), error);
#endif
}

struct TilePoint {
  TileVec x, y, z;  // in the ray's space, sheared
};

// Hits of the quads' triangles `half`, in the order of lanes.
struct TileHit {
  std::uint32_t lanes;  // a bit for each that is hit in [tnear, tfar]
  HWY_ALIGN float t[kTileLanes], u[kTileLanes], v[kTileLanes];
};

template <Movement kMovement>
class GridTest {
 public:
  GridTest(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& ray)
      : grid_(grid_of(block)),
        ray_(ray),
        moving_(kMovement != Movement::kStill && block.level != 0),
        degree_(kMovement == Movement::kPolynomial ? block.degree : 1),
        at_(kMovement == Movement::kStill ? SegmentTime{0, 0.0f} : ray.at_level[block.level]),
        weights_(TileTag(), at_.w),
        first_control_(at_.key * degree_),
        first_(bvh.grids[grid_.mesh]->values.data() + grid_.first_value +
               3 * std::size_t(grid_.plane_stride) * first_control_) {}

  // A bit for each tile that is hit before `tfar`.
  HWY_INLINE std::uint32_t tiles(float tfar, float* distance) const {
    return test_boxes<kMovement, false>(grid_.tiles() + first_control_, moving_, degree_, at_, ray_, tfar,
                                        distance);
  }

  // Both triangles of each of a tile's quads; `pass` counts the groups of lanes that a tile takes.
  static constexpr std::size_t passes() { return kTileLanes / hn::MaxLanes(TileTag()); }
  HWY_INLINE void test(std::uint32_t tile, std::size_t pass, float tfar, TileHit (&out)[2]) const {
    const std::uint32_t row = first_row(tile, pass), column = tile % 2 * kTileColumns;
    out[0].lanes = out[1].lanes = 0;
    if (row >= grid_.rows) return;
    const Rows r = rows_of(row, column);
    const TilePoint a = point(r.row[0], r.row[1]), b = point(r.row[0] + 1, r.row[1] + 1);
    const TilePoint c = point(r.row[1] + 1, r.row[2] + 1), d = point(r.row[1], r.row[2]);
    const std::uint32_t lanes = valid_lanes(row, column);
    // The diagonal's function is not reused with its sign changed: distances are then those of the same
    // triangles in blocks of their own, bit by bit.
    finish(edge_function(c.x, b.y, c.y, b.x), edge_function(a.x, c.y, a.y, c.x),
           edge_function(b.x, a.y, b.y, a.x), {a.z, b.z, c.z}, tfar, lanes, out[0]);
    finish(edge_function(d.x, c.y, d.y, c.x), edge_function(a.x, d.y, a.y, d.x),
           edge_function(c.x, a.y, c.y, a.x), {a.z, c.z, d.z}, tfar, lanes, out[1]);
  }

  HWY_INLINE std::uint32_t triangle_id(std::uint32_t tile, std::size_t pass, std::uint32_t lane,
                                       std::uint32_t half) const {
    const std::uint32_t row = first_row(tile, pass) + lane / kTileColumns;
    const std::uint32_t column = tile % 2 * kTileColumns + lane % kTileColumns;
    return grid_.first_triangle + 2 * (row * grid_.grid_columns + column) + half;
  }
  std::uint32_t mesh() const { return grid_.mesh; }

 private:
  static constexpr bool kWide = hn::MaxLanes(TileTag()) == kTileLanes;

  static std::uint32_t first_row(std::uint32_t tile, std::size_t pass) {
    return tile / 2 * kTileRows + static_cast<std::uint32_t>(pass);
  }
  HWY_INLINE std::uint32_t valid_lanes(std::uint32_t row, std::uint32_t column) const {
    const std::uint32_t columns = std::min<std::uint32_t>(kTileColumns, grid_.columns - column);
    const std::uint32_t one_row = (1u << columns) - 1u;
    return kWide && row + 1 < grid_.rows ? one_row | one_row << kTileColumns : one_row;
  }

  // Rows of points of a tile, from its column on. A row below the last is read as the last.
  struct Rows {
    const float* row[kTileRows + 1];
  };
  HWY_INLINE Rows rows_of(std::uint32_t row, std::uint32_t column) const {
    Rows out;
    for (std::uint32_t i = 0; i <= kTileRows; ++i) {
      const std::uint32_t r = std::min<std::uint32_t>(row + i, grid_.rows);
      out.row[i] = first_ + std::size_t(r) * grid_.row_stride + column;
    }
    return out;
  }

  // Four points of a row, and of the next. Lanes beyond the window hold points of other windows (or of the
  // guard), which valid_lanes() leaves out.
  static HWY_INLINE TileVec load(const float* here, [[maybe_unused]] const float* below) {
    if constexpr (kWide) {
      const hn::Half<TileTag> half;
      return hn::Combine(TileTag(), hn::LoadU(half, below), hn::LoadU(half, here));
    } else {
      return hn::LoadU(TileTag(), here);
    }
  }

  // An axis of quads' corners of one kind, at the ray's time and relative to its origin.
  HWY_INLINE TileVec relative(const float* here, const float* below, int axis) const {
    const std::size_t plane = std::size_t(static_cast<std::uint32_t>(axis)) * grid_.plane_stride;
    here += plane;
    below += plane;
    TileVec x = load(here, below);
    if (moving_) {
      const std::size_t skip = 3 * std::size_t(grid_.plane_stride);
      if (kMovement == Movement::kPolynomial) {
        x = simd_bezier([&](std::uint32_t i) { return load(here + skip * i, below + skip * i); }, degree_,
                        weights_);
      } else {
        x = simd_lerp<TileTag>(x, load(here + skip, below + skip), weights_);
      }
    }
    return hn::Sub(x, hn::Set(TileTag(), ray_.org[axis]));
  }

  HWY_INLINE TilePoint point(const float* here, const float* below) const {
    const TileTag d;
    const TileVec z = relative(here, below, ray_.kz);
    return {hn::NegMulAdd(hn::Set(d, ray_.shear_x), z, relative(here, below, ray_.kx)),
            hn::NegMulAdd(hn::Set(d, ray_.shear_y), z, relative(here, below, ray_.ky)),
            hn::Mul(hn::Set(d, ray_.scale_z), z)};
  }

  struct Depths {
    TileVec a, b, c;
  };
  HWY_INLINE void finish(TileVec weight_a, TileVec weight_b, TileVec weight_c, const Depths& z, float tfar,
                         std::uint32_t lanes, TileHit& out) const {
    const TileTag d;
    const TileVec zero = hn::Zero(d);
    const TileVec least = hn::Min(hn::Min(weight_a, weight_b), weight_c);
    const TileVec most = hn::Max(hn::Max(weight_a, weight_b), weight_c);
    const TileVec sum = hn::Add(hn::Add(weight_a, weight_b), weight_c);
    const auto inside = hn::And(hn::Or(hn::Ge(least, zero), hn::Le(most, zero)), hn::Ne(sum, zero));
    if (hn::AllFalse(d, inside)) return;
    const TileVec reciprocal = hn::Div(hn::Set(d, 1.0f), sum);
    const TileVec t =
        hn::Mul(hn::MulAdd(weight_a, z.a, hn::MulAdd(weight_b, z.b, hn::Mul(weight_c, z.c))), reciprocal);
    const auto in_range = hn::And(hn::Ge(t, hn::Set(d, ray_.tnear)), hn::Le(t, hn::Set(d, tfar)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::And(inside, in_range), bits);
    out.lanes = bits[0] & lanes;
    hn::Store(t, d, out.t);
    hn::Store(hn::Mul(weight_b, reciprocal), d, out.u);
    hn::Store(hn::Mul(weight_c, reciprocal), d, out.v);
  }

  const GridBlock& grid_;
  const RaySetup<kMovement>& ray_;
  const bool moving_;
  const std::uint32_t degree_;
  const SegmentTime at_;
  const Weights<TileTag> weights_;
  const std::size_t first_control_;
  const float* const first_;  // the window's first point at the first control in force
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
