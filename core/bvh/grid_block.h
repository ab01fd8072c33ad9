// A leaf block that stands for a window of a grid: where its points are, and the boxes of up to 8 tiles of 2
// x 4 quads at each control, so that a ray looks at the points of a tile or two and not of all. For 64 quads
// that is 96 bytes and 192 a control (3 a quad), beside the points' own 12 a control; quads and triangles are
// never written.
//
//   block | BlockHeader | GridBlock 48 B | tiles at control 0, 192 B | ... |
//
// Starts on a cache line, so that tiles are tested as a node's children are. BlockHeader::owner is the mesh
// in Bvh::grids.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/build/reference.h"
#include "core/bvh/bvh.h"
#include "core/bvh/layout.h"

namespace msbvh {

inline constexpr std::uint32_t kTileRows = 2, kTileColumns = 4;  // tile i: row i / 2, column i % 2
static_assert(kPatchQuads / kTileRows * (kPatchQuads / kTileColumns) == kWidth);

struct alignas(16) GridBlock {
  std::uint64_t first_value = 0;     // of the window's first point at control 0, in GridMesh::values
  std::uint32_t patch = 0;           // in GridMesh::patches, of which the window is all or a part
  std::uint32_t row_stride = 0;      // floats from a row to the next
  std::uint32_t plane_stride = 0;    // from an axis to the next; three of them to the next control
  std::uint32_t first_triangle = 0;  // of the window's first quad
  std::uint32_t grid_columns = 0;    // quads from a row to the next
  std::uint16_t rows = 0, columns = 0;
  std::uint32_t unused[4] = {};

  const NodeBounds* tiles() const { return reinterpret_cast<const NodeBounds*>(this + 1); }
  NodeBounds* tiles() { return reinterpret_cast<NodeBounds*>(this + 1); }
};
static_assert((sizeof(BlockHeader) + sizeof(GridBlock)) % alignof(NodeBounds) == 0);

constexpr std::size_t grid_block_bytes(const TrackForm& form) {
  return sizeof(BlockHeader) + sizeof(GridBlock) + form.controls() * sizeof(NodeBounds);
}
inline const GridBlock& grid_of(const BlockHeader& block) {
  return *reinterpret_cast<const GridBlock*>(&block + 1);
}

// The part of its grid that a block stands for.
GridPatch window_of(const GridMesh& mesh, const GridBlock& block);

// Writes what follows the header; the window of a fragment is the smallest that holds its pieces.
void write_grid_block(const Primitives& primitives, const Reference& reference, BlockHeader& block);

}  // namespace msbvh
