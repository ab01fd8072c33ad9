#include "core/bvh/verify_grids.h"

#include <algorithm>
#include <string>

#include "core/base/error.h"
#include "core/bvh/grid_block.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

constexpr int kSamplesPerEdge = 6;  // barycentric grid on a triangle in several leaves
constexpr std::uint32_t kInstantsPerSegment = 4;

[[noreturn]] void fail(const std::string& what) { throw Error("accelerator: a patch: " + what); }

bool holds(const GridPatch& window, const GridTriangle& t) {
  return t.grid == window.grid && t.row >= window.row && t.row < std::uint32_t(window.row + window.rows) &&
         t.column >= window.column && t.column < std::uint32_t(window.column + window.columns);
}

}  // namespace

void GridVerifier::add(const BlockHeader& block, const Slot& slot) {
  const GridBlock& b = grid_of(block);
  if ((reinterpret_cast<const std::byte*>(&block) - bvh_.get().arena.data()) % AlignedBuffer::kAlignment != 0)
    fail("its block does not start on a cache line");
  if (!block.last) fail("it is not alone in its leaf");
  if (block.owner >= bvh_.get().grids.size()) fail("mesh id out of range");
  const GridMesh& mesh = *bvh_.get().grids[block.owner];
  if (b.patch >= mesh.patches.size() || b.first_triangle >= mesh.triangle_count()) fail("id out of range");
  if (mesh.form() != block.form()) fail("a block's controls are not its mesh's");
  const GridPatch window = window_of(mesh, b), &patch = mesh.patches[b.patch];
  const GridTriangle last{window.grid, window.row + window.rows - 1u, window.column + window.columns - 1u, 1};
  if (!holds(patch, {window.grid, window.row, window.column, 0}) || !holds(patch, last))
    fail("a window leaves its patch");
  check_tiles(mesh, block, window);
  leaves_[{block.owner, b.patch}].push_back({window, slot});
}

void GridVerifier::check_tiles(const GridMesh& mesh, const BlockHeader& block,
                               const GridPatch& window) const {
  const GridBlock& b = grid_of(block);
  const Grid& grid = mesh.grids[window.grid];
  for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) {
    const float* first = mesh.values.data() + b.first_value + 3 * std::size_t(c) * b.plane_stride;
    for (std::uint32_t row = 0; row <= window.rows; ++row) {
      for (std::uint32_t column = 0; column <= window.columns; ++column) {
        const Vec3f p = mesh.control_point(grid, window.row + row, window.column + column, c);
        const float* at = first + row * b.row_stride + column;
        if (p != Vec3f{at[0], at[b.plane_stride], at[2 * std::size_t(b.plane_stride)]})
          fail("its points are not where its block says");
        // A point on a border is one of two tiles, or of four.
        for (std::uint32_t i = 0; i < kWidth; ++i) {
          const std::uint32_t r = i / 2 * kTileRows, k = i % 2 * kTileColumns;
          if (r >= window.rows || k >= window.columns) continue;
          const bool of_tile = row >= r && row <= r + kTileRows && column >= k && column <= k + kTileColumns;
          if (of_tile && !b.tiles()[c].box(i).contains(p)) fail("a point leaves its tile");
        }
      }
    }
  }
}

// Each point of a triangle, moved as its vertices are, in one of the leaves that hold it.
void GridVerifier::check_triangle(const GridMesh& mesh, std::uint32_t id,
                                  const std::vector<Leaf>& leaves) const {
  const GridTriangle t = mesh.triangle(id);
  TrackForm form = mesh.form();
  for (const Leaf& leaf : leaves) form = common_form(form, leaf.slot.form);
  const std::uint32_t steps = form.segments * (form.degree == 1 ? 2 : kInstantsPerSegment);
  const int samples = leaves.size() == 1 ? 1 : kSamplesPerEdge;
  for (std::uint32_t k = 0; k <= steps; ++k) {
    const float u = slice_.time(steps == 0 ? 0.0f : static_cast<float>(k) / static_cast<float>(steps));
    Vec3d v[3];
    for (int i = 0; i < 3; ++i)
      v[i] = Vec3d(mesh.point(mesh.grids[t.grid], vertices_of(t)[i].row, vertices_of(t)[i].column, u));
    const Vec3d lo = min(min(v[0], v[1]), v[2]), hi = max(max(v[0], v[1]), v[2]);
    for (int i = 0; i <= samples; ++i) {
      for (int j = 0; i + j <= samples; ++j) {
        const double b1 = double(i) / samples, b2 = double(j) / samples;
        // The exact point lies between the corners, where pieces that no box cuts are not padded: rounding
        // must not carry the sample out.
        const Vec3d p = max(lo, min(hi, v[0] * (1.0 - b1 - b2) + v[1] * b1 + v[2] * b2));
        const bool inside = std::ranges::any_of(leaves, [&](const Leaf& leaf) {
          const Box3f box = leaf.slot.at(u);
          return holds(leaf.window, t) && Box3d{Vec3d(box.lo), Vec3d(box.hi)}.contains(p);
        });
        if (!inside)
          fail("a point of triangle " + std::to_string(id) +
               " is outside its leaves at u = " + std::to_string(u));
      }
    }
  }
}

void GridVerifier::finish() const {
  std::size_t patches = 0;
  for (const auto& mesh : bvh_.get().grids) patches += mesh->patches.size();
  if (leaves_.size() != patches) {
    throw Error("accelerator: " + std::to_string(leaves_.size()) + " patches in leaves; expected " +
                std::to_string(patches));
  }
  for (const auto& [id, leaves] : leaves_) {
    const GridMesh& mesh = *bvh_.get().grids[id.first];
    const GridPatch& p = mesh.patches[id.second];
    for (std::uint32_t i = 0; i < 2u * p.rows * p.columns; ++i) {
      const GridTriangle t{p.grid, p.row + i / 2 / p.columns, p.column + i / 2 % p.columns, i % 2};
      check_triangle(mesh, mesh.triangle_id(t), leaves);
    }
  }
}

}  // namespace msbvh
