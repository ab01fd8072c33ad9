#include "core/bvh/leaf_blocks.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <tuple>

namespace msbvh {
namespace {

// Adds the triangle, unless it is there already. False: its vertices do not fit.
bool add_triangle(const TriangleMesh& mesh, std::uint32_t id, LeafBlock& block) {
  if (block.count > 0 && block.triangles[block.count - 1] == id) return true;
  if (block.count == kBlockWidth) return false;
  std::uint32_t vertices = block.vertex_count;
  std::array<std::uint8_t, 3> corner;
  for (std::uint32_t v = 0; v < 3; ++v) {
    const std::uint32_t vertex = mesh.triangles[id][v];
    const auto known = std::find(block.vertices.begin(), block.vertices.begin() + vertices, vertex);
    corner[v] = static_cast<std::uint8_t>(known - block.vertices.begin());
    if (corner[v] < vertices) continue;
    if (vertices == kBlockVertices) return false;
    block.vertices[vertices++] = vertex;
  }
  for (std::uint32_t v = 0; v < 3; ++v) block.corners[v][block.count] = corner[v];
  block.triangles[block.count++] = id;
  block.vertex_count = vertices;
  return true;
}

void write_vertices(const TriangleMesh& mesh, const LeafBlock& block, std::byte* at) {
  const std::uint32_t row = BlockHeader::padded_vertices(block.vertex_count);
  const auto vertex = [&](std::uint32_t i) { return block.vertices[std::min(i, block.vertex_count - 1)]; };
  if (block.kind == BlockKind::kIndexed) {
    auto* indices = reinterpret_cast<std::uint32_t*>(at);
    for (std::uint32_t i = 0; i < row; ++i) indices[i] = vertex(i);
    return;
  }
  auto* out = reinterpret_cast<float*>(at);
  for (std::uint32_t c = 0; c < block.form.controls(); ++c, out += 3 * row) {
    const Vec3f* positions = mesh.control_positions(c);
    for (std::uint32_t i = 0; i < row; ++i) {
      const Vec3f& p = positions[vertex(i)];
      for (int axis = 0; axis < 3; ++axis) out[axis * static_cast<int>(row) + static_cast<int>(i)] = p[axis];
    }
  }
}

void write_triangles(const TriangleMesh& mesh, const LeafBlock& block, const BlockHeader& header,
                     std::byte* at) {
  auto* ids = reinterpret_cast<std::uint32_t*>(at + sizeof(BlockHeader));
  auto* corners = reinterpret_cast<std::uint8_t*>(ids + header.lanes());
  for (std::uint32_t i = 0; i < header.lanes(); ++i) {
    const std::uint32_t lane = i < block.count ? i : 0;
    ids[i] = block.triangles[lane];
    for (std::uint32_t v = 0; v < 3; ++v) corners[v * header.lanes() + i] = block.corners[v][lane];
  }
  write_vertices(mesh, block, at + BlockHeader::fixed_bytes(block.count));
}

void write_ids(const LeafBlock& block, const BlockHeader& header, std::byte* at) {
  auto* ids = reinterpret_cast<std::uint32_t*>(at + sizeof(BlockHeader));
  for (std::uint32_t i = 0; i < header.lanes(); ++i) ids[i] = block.triangles[i < block.count ? i : 0];
}

BlockKind kind_of(const Primitives& primitives, const Reference& r, const TrackForm& form) {
  if (r.is_instance()) return BlockKind::kInstance;
  if (r.is_round()) return r.is_curve() ? BlockKind::kCurves : BlockKind::kPoints;
  return r.is_grid() ? BlockKind::kGrid : triangle_block_kind(primitives, form);
}

}  // namespace

BlockKind triangle_block_kind(const Primitives& primitives, const TrackForm& form) {
  const bool shared = form.moving() && !primitives.slice.whole();
  const bool indexed = primitives.indexed_leaves || shared || level_of(form.segments) > kMaxGatheredLevel;
  return indexed ? BlockKind::kIndexed : BlockKind::kGathered;
}

void sort_leaf(const Primitives& primitives, std::span<Reference> leaf) {
  const auto of_one_mesh = [&](const Reference& r) { return r.mesh() == leaf.front().mesh(); };
  if (!leaf.front().is_instance() && std::ranges::all_of(leaf, of_one_mesh)) {
    std::ranges::sort(leaf, {}, &Reference::index);  // the common case; no look at how they move
    return;
  }
  const auto order = [&](const Reference& r) {
    const TrackForm form = form_of(primitives, r);
    return std::tuple(form.segments, form.degree, r.mesh(), r.index);
  };
  std::sort(leaf.begin(), leaf.end(),
            [&](const Reference& a, const Reference& b) { return order(a) < order(b); });
}

LeafBlock first_block(const Primitives& primitives, std::span<const Reference> leaf) {
  const Reference& first = leaf.front();
  LeafBlock block;
  block.first = first;
  block.form = form_of(primitives, first);
  block.kind = kind_of(primitives, first, block.form);
  block.owner = first.is_instance() ? first.index : first.is_grid() ? first.grid_mesh() : first.mesh();
  block.references = 1;
  if (block.kind == BlockKind::kInstance) {
    block.part = primitives.parts[first.index];
    block.owner = block.part.instance;
  }
  if (block.is_round()) {
    block.owner = first.round_set();
    block.references = 0;
    for (const Reference& r : leaf) {
      if (r.owner != first.owner || block.count == kBlockWidth) break;
      block.triangles[block.count++] = r.index;
      ++block.references;
    }
  }
  if (!block.has_triangles()) return block;
  const TriangleMesh& mesh = *primitives.meshes[block.owner];
  add_triangle(mesh, first.index, block);
  for (const Reference& r : leaf.subspan(1)) {
    if (r.is_instance() || r.is_grid() || r.is_round() || r.mesh() != block.owner ||
        !add_triangle(mesh, r.index, block))
      break;
    ++block.references;
  }
  return block;
}

void write_block(const Primitives& primitives, const LeafBlock& block, bool last, std::byte* at) {
  std::memset(at, 0, block.bytes());  // no byte is left to chance
  BlockHeader& header = *new (at) BlockHeader{};
  header.kind = block.kind;
  header.form_code = FormCode::of(block.form);
  header.count = static_cast<std::uint8_t>(block.count);
  header.vertex_count = static_cast<std::uint8_t>(block.vertex_count);
  header.last = last;
  header.owner = block.owner;
  header.units = static_cast<std::uint32_t>(block.bytes() / kUnit);
  if (block.kind == BlockKind::kInstance && !block.part.is_whole()) {
    header.is_part = 1;
    header.form_code = {block.part.form};
    header.units = block.part.child;
  }
  if (block.kind == BlockKind::kGrid) write_grid_block(primitives, block.first, header);
  if (block.is_round()) write_ids(block, header, at);
  if (block.has_triangles()) write_triangles(*primitives.meshes[block.owner], block, header, at);
}

}  // namespace msbvh
