// The blocks of a leaf: which of its references share one, and their bytes (core/bvh/layout.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/build/reference.h"
#include "core/bvh/grid_block.h"
#include "core/bvh/layout.h"

namespace msbvh {

// What goes into one block: an instance, a patch or a fragment of one, up to kBlockWidth pieces of curves or
// points of one set, or as many triangles of one mesh that have up to kBlockVertices vertices between them.
struct LeafBlock {
  BlockKind kind;
  std::uint32_t owner;  // mesh or instance id
  Reference first;      // of those it takes
  InstancePart part;    // of an instance
  TrackForm form;
  std::size_t references;  // how many of the leaf's it takes
  std::uint32_t count = 0, vertex_count = 0;
  std::array<std::uint32_t, kBlockWidth> triangles;
  std::array<std::array<std::uint8_t, kBlockWidth>, 3> corners;
  std::array<std::uint32_t, kBlockVertices> vertices;  // in the mesh

  bool has_triangles() const { return kind == BlockKind::kGathered || kind == BlockKind::kIndexed; }
  bool is_round() const { return kind == BlockKind::kCurves || kind == BlockKind::kPoints; }
  std::size_t bytes() const {
    if (kind == BlockKind::kGrid) return grid_block_bytes(form);
    if (is_round()) return round_block_bytes(count);
    return has_triangles() ? triangle_block_bytes(kind, form, count, vertex_count) : sizeof(BlockHeader);
  }
};

// How the blocks of triangles that move like this hold their vertices. Trees for slices of the shutter share
// the meshes' tracks: gathered, each would have a copy.
BlockKind triangle_block_kind(const Primitives& primitives, const TrackForm& form);

// Brings a leaf's references into the order in which first_block() takes them.
void sort_leaf(const Primitives& primitives, std::span<Reference> leaf);

// The block that the first of the sorted references go into; leaf must not be empty. Two fragments of one
// triangle that meet again in a leaf share an entry.
LeafBlock first_block(const Primitives& primitives, std::span<const Reference> leaf);

// Writes block.bytes() bytes.
void write_block(const Primitives& primitives, const LeafBlock& block, bool last, std::byte* at);

}  // namespace msbvh
