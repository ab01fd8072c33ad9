// The bytes of a tree, as traversal reads them. One arena holds nodes and leaves, children behind their
// parent, depth first; positions in it are counted in units of 16 bytes.
//
//   node  | header 64 B | boxes at control 0, 192 B | ... | boxes at the last control, 192 B |
//   leaf  | block | block | ... | last block |
//   block | header 16 B | data |
//
// Nodes start on a cache line. A block holds up to 8 triangles of one mesh that share up to 16 vertices: each
// vertex is read and moved to the ray's time once, however many of the triangles meet in it. Its data:
//
//   triangles    a 4-byte id each, for 4 or 8 of them
//   corners      3 x 4 or 3 x 8 bytes: positions among the block's vertices, padded to 16 bytes
//   vertices     gathered: at each control x, y, z of all vertices, each row padded to 4 floats; one stream,
//                for few segments
//                indexed: 4 bytes a vertex, into the mesh's own tracks; for many segments
//
// The block of an instance, or of a part of one, is a header alone, and alone in its leaf; that of a window
// of a grid, alone in its leaf and on a cache line, is described in core/bvh/grid_block.h. That of up to 8
// pieces of curves or points of one set is a header and their ids; vertices are read in the set's own tracks.
//
// In a compact tree (TreeLayout::kCompact) a node's boxes take 96 B a control
// (core/bvh/compact_bounds.h), and all blocks of triangles are indexed.
//
// A ray reads two controls of a node (degree + 1 of a Bezier track), whatever their number. Every node and
// block has as many controls as it needs, no more.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/box.h"
#include "core/bvh/compact_bounds.h"
#include "core/geometry/geometry_id.h"
#include "core/motion/track.h"

namespace msbvh {

inline constexpr std::uint32_t kWidth = 8;           // children of a node
inline constexpr std::uint32_t kBlockWidth = 8;      // triangles of a block
inline constexpr std::uint32_t kBlockVertices = 16;  // and vertices that they share
inline constexpr std::uint32_t kMaxDepth = 96;       // of nodes; bounds the traversal stack
inline constexpr std::size_t kUnit = 16;             // bytes that positions are counted in

// The position of a node or a leaf in the arena.
struct ChildRef {
  std::uint32_t bits;

  static constexpr std::uint32_t kLeafFlag = 0x80000000u;
  static constexpr ChildRef node(std::uint32_t unit) { return {unit}; }
  static constexpr ChildRef leaf(std::uint32_t unit) { return {unit | kLeafFlag}; }
  constexpr bool is_leaf() const { return (bits & kLeafFlag) != 0; }
  constexpr std::size_t offset() const { return std::size_t(bits & ~kLeafFlag) * kUnit; }
};

// Key counts as an index into a ray's table of segment times: 0 still, 1 + k for 2^k segments, and one
// segment that spans the slice of the shutter that a node's tree is for (Builder::kTimeSplit).
inline constexpr std::uint32_t kLevels = 10;
inline constexpr std::uint32_t kSliceLevel = kLevels - 1;
constexpr std::uint32_t level_of(std::uint32_t segments) {
  std::uint32_t level = 0;
  while (segments != 0) {
    ++level;
    segments >>= 1;
  }
  return level;
}
constexpr std::uint32_t segments_of_level(std::uint32_t level) {
  return level == 0 ? 0 : level == kSliceLevel ? 1 : 1u << (level - 1);
}

// A track's form in a byte; and how many bytes a control takes there, so that a ray may fetch its own key's
// before it has seen the node, or the leaf's first block.
struct FormCode {
  std::uint8_t bits;

  static constexpr FormCode of(const TrackForm& form) {
    return {static_cast<std::uint8_t>(level_of(form.segments) | form.degree << 4)};
  }
  static constexpr FormCode of_slice(std::uint32_t degree) {
    return {static_cast<std::uint8_t>(kSliceLevel | degree << 4)};
  }
  // Of a gathered block; a node's control is as long as that of a block of kBlockVertices.
  constexpr FormCode with_vertices(std::uint32_t vertices) const {
    return {static_cast<std::uint8_t>(bits | (vertices - 1) / 4 << 6)};
  }
  constexpr FormCode of_node(bool compact = false) const {
    return with_vertices(compact ? kBlockVertices / 2 : kBlockVertices);
  }
  constexpr std::uint32_t level() const { return bits & 15u; }
  constexpr std::uint32_t degree() const { return bits >> 4 & 3u; }
  constexpr std::size_t control_bytes() const { return 4 * ((bits >> 6) + 1u) * 3 * sizeof(float); }
  constexpr TrackForm form() const { return {segments_of_level(level()), degree()}; }
};

// The boxes of 8 children at one control. An absent child has lo = kAbsent, hi = -kAbsent: no ray hits it,
// and it stays finite under interpolation.
// Both sides of an axis fill a cache line.
struct alignas(64) NodeBounds {
  struct Axis {
    float lo[kWidth], hi[kWidth];
  };
  Axis axis[3];

  Box3f box(std::uint32_t child) const {
    return {{axis[0].lo[child], axis[1].lo[child], axis[2].lo[child]},
            {axis[0].hi[child], axis[1].hi[child], axis[2].hi[child]}};
  }
  void set_box(std::uint32_t child, const Box3f& box) {
    for (int a = 0; a < 3; ++a) {
      axis[a].lo[child] = box.lo[a];
      axis[a].hi[child] = box.hi[a];
    }
  }
};
inline constexpr float kAbsent = 1e37f;

struct alignas(64) NodeHeader {
  ChildRef child[kWidth];
  // Of each child, or of a leaf's first block, so that a ray knows what it will read at its own key before it
  // has touched the child.
  FormCode child_form[kWidth];
  FormCode form_code;
  std::uint8_t child_count;
  // A bit for each child below which there are triangles alone and none moves: rays need no time there.
  std::uint8_t still_children;
  bool compact;     // as every node of the tree
  NodeFrame frame;  // of compact boxes

  TrackForm form() const { return form_code.form(); }

  const NodeBounds* bounds() const { return reinterpret_cast<const NodeBounds*>(this + 1); }
  NodeBounds* bounds() { return reinterpret_cast<NodeBounds*>(this + 1); }
  const CompactBounds* compact_bounds() const { return reinterpret_cast<const CompactBounds*>(this + 1); }
  CompactBounds* compact_bounds() { return reinterpret_cast<CompactBounds*>(this + 1); }
  Box3f box(std::uint32_t control, std::uint32_t child_slot) const {
    return compact ? compact_bounds()[control].box(frame, child_slot) : bounds()[control].box(child_slot);
  }
};

// Curves and points are the last.
enum class BlockKind : std::uint8_t { kGathered, kIndexed, kInstance, kGrid, kCurves, kPoints };

struct alignas(16) BlockHeader {
  BlockKind kind;
  FormCode form_code;
  std::uint8_t count;         // triangles, 1 to kBlockWidth; unused lanes repeat the first triangle
  std::uint8_t vertex_count;  // 3 to kBlockVertices
  std::uint8_t last;          // 1: no block follows in this leaf
  std::uint8_t is_part;  // of an instance: 1 where a ray does not begin at the object's root, but at part()
  std::uint8_t unused[2];
  std::uint32_t owner;  // mesh, set of curves or points, or instance id
  std::uint32_t units;  // of kUnit, header included: where the next block is; or the bits of part()

  TrackForm form() const { return form_code.form(); }
  // Not of an instance.
  GeometryId geometry() const {
    if (kind < BlockKind::kInstance) return {GeometryKind::kTriangleMesh, owner};
    return {kind == BlockKind::kGrid     ? GeometryKind::kGridMesh
            : kind == BlockKind::kCurves ? GeometryKind::kCurves
                                         : GeometryKind::kPoints,
            owner};
  }
  // Of an instance's part: a place in the object's tree, in the form `form_code`.
  ChildRef part() const { return {units}; }

  std::uint32_t lanes() const { return count <= kBlockWidth / 2 ? kBlockWidth / 2 : kBlockWidth; }
  // Of triangles; of pieces of curves, CurvePiece::code(); of points.
  const std::uint32_t* triangles() const { return reinterpret_cast<const std::uint32_t*>(this + 1); }
  // Of vertex `v` of each triangle. May be read 8 bytes at a time.
  const std::uint8_t* corners(std::uint32_t v) const {
    return reinterpret_cast<const std::uint8_t*>(triangles() + lanes()) + v * lanes();
  }
  // Of kGathered: rows of row_floats() floats, [control][axis]. May be read 16 floats at a time.
  const float* vertices() const {
    return reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(this) + fixed_bytes(count));
  }
  std::uint32_t row_floats() const { return padded_vertices(vertex_count); }
  // Of kIndexed: row_floats() positions in the mesh's tracks, the last one repeated.
  const std::uint32_t* vertex_indices() const { return reinterpret_cast<const std::uint32_t*>(vertices()); }

  static constexpr std::uint32_t padded_vertices(std::uint32_t vertices) { return (vertices + 3) / 4 * 4; }
  // Header, ids and corners.
  static constexpr std::size_t fixed_bytes(std::uint32_t count) {
    return count <= kBlockWidth / 2 ? 16 + 16 + 16 : 16 + 32 + 32;
  }
};

static_assert(FormCode{0}.of_node().control_bytes() == sizeof(NodeBounds));
static_assert(FormCode{0}.of_node(true).control_bytes() == sizeof(CompactBounds));
static_assert(sizeof(NodeHeader) == 64 && sizeof(NodeBounds) == 192 && sizeof(BlockHeader) == 16);

// Whole vectors are read where rows are shorter: so many bytes after the last block belong to the arena.
inline constexpr std::size_t kArenaGuard = 64;

// Up to this level, 9 keys, blocks are gathered: 1.1 to 1.3 times the rays a second of indexed ones for up to
// twice the bytes (docs/design/build.md).
inline constexpr std::uint32_t kMaxGatheredLevel = 4;

// A whole number of cache lines.
constexpr std::size_t node_bytes(const TrackForm& form, bool compact) {
  const std::size_t boxes = form.controls() * (compact ? sizeof(CompactBounds) : sizeof(NodeBounds));
  return sizeof(NodeHeader) + (boxes + 63) / 64 * 64;
}
constexpr std::size_t round_block_bytes(std::uint32_t count) {
  return sizeof(BlockHeader) +
         (count <= kBlockWidth / 2 ? kBlockWidth / 2 : kBlockWidth) * sizeof(std::uint32_t);
}
constexpr std::size_t triangle_block_bytes(BlockKind kind, const TrackForm& form, std::uint32_t count,
                                           std::uint32_t vertices) {
  const std::size_t row = BlockHeader::padded_vertices(vertices) * sizeof(float);
  return BlockHeader::fixed_bytes(count) + (kind == BlockKind::kGathered ? form.controls() * 3 * row : row);
}

}  // namespace msbvh
