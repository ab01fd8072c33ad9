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
#include "core/trace/triangle_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// 8 quads of a tile at once, or its two rows of 4 one after the other.
inline constexpr std::uint32_t kTileQuads = kTileRows * kTileColumns;
static_assert(kTileQuads == kBlockWidth);

template <Movement kMovement>
class GridTest {
 public:
  HWY_INLINE GridTest(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& ray)
      : grid_(grid_of(block)),
        ray_(ray),
        moves_(kMoving && block.form_code.level() != 0),
        degree_(kMovement == Movement::kPolynomial ? block.form_code.degree() : 1),
        at_(ray.at_level[kMoving ? block.form_code.level() : 0]),
        first_control_(at_.key * degree_),
        first_(bvh.grids[block.owner]->values.data() + grid_.first_value +
               3 * std::size_t(grid_.plane_stride) * first_control_) {}

  // The tiles as a node's children; `hits` gets a bit for each that is hit before `tfar`.
  HWY_INLINE ChildKeys tiles(float tfar, std::uint32_t& hits) const {
    return test_boxes<kMovement>(grid_.tiles() + first_control_, moves_, degree_, at_.w, ray_, tfar, hits);
  }

  // Both triangles of each of a tile's quads; `pass` counts the groups of lanes that a tile takes.
  static constexpr std::uint32_t kPasses = kTileQuads / kLanes8;
  HWY_INLINE void test(std::uint32_t tile, std::uint32_t pass, float tfar, BlockHit (&out)[2]) const {
    const std::uint32_t row = first_row(tile, pass), column = tile % 2 * kTileColumns;
    out[0].lanes = out[1].lanes = 0;
    if (row >= grid_.rows) return;
    const Rows r = rows_of(row, column);
    const Sheared<V8> a = point(r.row[0], r.row[1]), b = point(r.row[0] + 1, r.row[1] + 1);
    const Sheared<V8> c = point(r.row[1] + 1, r.row[2] + 1), d = point(r.row[1], r.row[2]);
    const std::uint32_t lanes = valid_lanes(row, column);
    // The diagonal's function is not reused with its sign changed: distances are then those of the same
    // triangles in blocks of their own, bit by bit.
    out[0].lanes = lanes & test_corners(a, b, c, ray_.tnear, tfar, 0, out[0]);
    out[1].lanes = lanes & test_corners(a, c, d, ray_.tnear, tfar, 0, out[1]);
  }

  HWY_INLINE std::uint32_t triangle_id(std::uint32_t tile, std::uint32_t pass, std::uint32_t lane,
                                       std::uint32_t half) const {
    const std::uint32_t row = first_row(tile, pass) + lane / kTileColumns;
    const std::uint32_t column = tile % 2 * kTileColumns + lane % kTileColumns;
    return grid_.first_triangle + 2 * (row * grid_.grid_columns + column) + half;
  }

 private:
  static constexpr bool kMoving = kMovement != Movement::kStill;
  static constexpr bool kWide = kPasses == 1;

  static std::uint32_t first_row(std::uint32_t tile, std::uint32_t pass) {
    return tile / 2 * kTileRows + pass;
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
  static HWY_INLINE V8 load(const float* here, [[maybe_unused]] const float* below) {
    if constexpr (kWide) {
      const hn::Half<D8> half;
      return hn::Combine(D8(), hn::LoadU(half, below), hn::LoadU(half, here));
    } else {
      return hn::LoadU(D8(), here);
    }
  }

  // An axis of quads' corners of one kind, at the ray's time and relative to its origin.
  HWY_INLINE V8 relative(const float* here, const float* below, int axis) const {
    const std::size_t plane = std::size_t(static_cast<std::uint32_t>(axis)) * grid_.plane_stride;
    const std::size_t stride = std::size_t(moves_) * 3 * grid_.plane_stride;  // as of a node's boxes
    const auto control = [&](std::uint32_t c) {
      const std::size_t skip = plane + c * stride;
      return load(here + skip, below + skip);
    };
    const V8 x = kMoving ? simd_bezier(control, degree_, Weights<D8>(D8(), at_.w)) : control(0);
    return hn::Sub(x, hn::Set(D8(), ray_.org[axis]));
  }

  HWY_INLINE Sheared<V8> point(const float* here, const float* below) const {
    const D8 d;
    const V8 z = relative(here, below, ray_.axes.z);
    return {hn::NegMulAdd(hn::Set(d, ray_.shear.x), z, relative(here, below, ray_.axes.x)),
            hn::NegMulAdd(hn::Set(d, ray_.shear.y), z, relative(here, below, ray_.axes.y)),
            hn::Mul(hn::Set(d, ray_.shear.scale_z), z)};
  }

  const GridBlock& grid_;
  const RaySetup<kMovement>& ray_;
  const bool moves_;
  const std::uint32_t degree_;
  const SegmentTime at_;
  const std::size_t first_control_;
  const float* const first_;  // the window's first point at the first control in force
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
