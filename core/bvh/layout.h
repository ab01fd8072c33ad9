// The bytes of a tree, as traversal reads them. One arena holds nodes and leaves, children behind their
// parent, depth first; positions in it are counted in units of 16 bytes.
//
//   node  | header 64 B | boxes at control 0, 192 B | ... | boxes at the last control, 192 B |
//   leaf  | block | block | ... | last block |
//   block | header 48 B | data |
//
// Nodes start on a cache line. The data of a block:
//
//   gathered  at each control 9 x 16 B: x y z of three vertices of four triangles; one stream, for few
//             segments
//   indexed   3 x 16 B: vertex indices into the meshes' own tracks; 24 B a triangle, for many
//             segments
//   instance  none; triangle[0] is the instance's id
//   grid      a window of a grid, alone in its leaf: core/bvh/grid_block.h
//
// A ray reads two controls of a node (degree + 1 of a Bezier track), whatever their number. Every node and
// block has as many controls as it needs, no more.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/motion/track.h"

namespace msbvh {

inline constexpr std::uint32_t kWidth = 8;       // children of a node
inline constexpr std::uint32_t kBlockWidth = 4;  // triangles of a block
inline constexpr std::uint32_t kMaxDepth = 96;   // of nodes; bounds the traversal stack
inline constexpr std::size_t kUnit = 16;         // bytes that positions are counted in

// The position of a node or a leaf in the arena.
struct ChildRef {
  std::uint32_t bits;

  static constexpr std::uint32_t kLeafFlag = 0x80000000u;
  static constexpr ChildRef node(std::uint32_t unit) { return {unit}; }
  static constexpr ChildRef leaf(std::uint32_t unit) { return {unit | kLeafFlag}; }
  constexpr bool is_leaf() const { return (bits & kLeafFlag) != 0; }
  constexpr std::size_t offset() const { return std::size_t(bits & ~kLeafFlag) * kUnit; }
};

// Key counts as an index into a ray's table of segment times: 0 still, 1 + k for 2^k segments.
inline constexpr std::uint32_t kLevels = 9;
constexpr std::uint32_t level_of(std::uint32_t segments) {
  std::uint32_t level = 0;
  while (segments != 0) {
    ++level;
    segments >>= 1;
  }
  return level;
}
constexpr std::uint32_t segments_of_level(std::uint32_t level) { return level == 0 ? 0 : 1u << (level - 1); }

// The boxes of 8 children at one control. An absent child has lo = kAbsent, hi = -kAbsent: no ray hits it,
// and it stays finite under interpolation.
struct NodeBounds {
  float lo[3][kWidth];
  float hi[3][kWidth];
};
inline constexpr float kAbsent = 1e37f;

struct alignas(64) NodeHeader {
  ChildRef child[kWidth];
  std::uint16_t level;
  std::uint16_t degree;
  std::uint32_t child_count;

  TrackForm form() const { return {segments_of_level(level), degree}; }

  const NodeBounds* bounds() const { return reinterpret_cast<const NodeBounds*>(this + 1); }
  NodeBounds* bounds() { return reinterpret_cast<NodeBounds*>(this + 1); }
};

enum class BlockKind : std::uint8_t { kGathered, kIndexed, kInstance, kGrid };

struct alignas(16) BlockHeader {
  BlockKind kind;
  std::uint8_t level;
  std::uint8_t count;  // triangles, 1 to 4; unused lanes repeat the first triangle
  std::uint8_t last;   // 1: no block follows in this leaf
  std::uint8_t degree;
  std::uint8_t unused[11];
  std::uint32_t mesh[kBlockWidth];
  std::uint32_t triangle[kBlockWidth];
};

// Data of a gathered block at one control: [vertex][axis][triangle].
struct GatheredKey {
  float position[3][3][kBlockWidth];
};

// Data of an indexed block: [vertex][triangle].
struct VertexIndices {
  std::uint32_t vertex[3][kBlockWidth];
};

static_assert(sizeof(NodeHeader) == 64 && sizeof(NodeBounds) == 192);
static_assert(sizeof(BlockHeader) == 48 && sizeof(GatheredKey) == 144 && sizeof(VertexIndices) == 48);

// Up to this level blocks are gathered; gathering pays at 2 keys and loses at 9 (docs/design/build.md).
inline constexpr std::uint32_t kMaxGatheredLevel = 1;

constexpr BlockKind triangle_block_kind(std::uint32_t level) {
  return level <= kMaxGatheredLevel ? BlockKind::kGathered : BlockKind::kIndexed;
}
constexpr std::size_t node_bytes(const TrackForm& form) {
  return sizeof(NodeHeader) + form.controls() * sizeof(NodeBounds);
}
constexpr std::size_t triangle_block_bytes(const TrackForm& form) {
  return sizeof(BlockHeader) + (triangle_block_kind(level_of(form.segments)) == BlockKind::kGathered
                                    ? form.controls() * sizeof(GatheredKey)
                                    : sizeof(VertexIndices));
}

}  // namespace msbvh
