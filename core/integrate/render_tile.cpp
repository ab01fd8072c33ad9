#include "core/integrate/render_tile.h"

#include <algorithm>
#include <utility>

namespace msbvh {
namespace {

// Squares of so many pixels along an edge.
std::vector<Tile> cut(const Tile& tile, std::uint32_t edge) {
  std::vector<Tile> parts;
  for (std::uint32_t y = tile.y0; y < tile.y1; y += edge) {
    for (std::uint32_t x = tile.x0; x < tile.x1; x += edge)
      parts.push_back({x, y, std::min(tile.x1, x + edge), std::min(tile.y1, y + edge)});
  }
  return parts;
}

}  // namespace

std::vector<Tile> areas_of(const TileJob& job, const Tile& tile) {
  if (job.noise.decides()) return cut(tile, kNoiseSquare);
  // Pixel by pixel: in a batch of many nobody can tell which took how long.
  if (job.frame.aovs.has(Aov::kSeconds)) return cut(tile, 1);
  return {tile};
}

AreaTraced render_tile(const TileJob& job, const Tile& tile, TileWorkspace& workspace, Image& image) {
  AreaTraced traced;
  PixelArea& area = workspace.area;
  for (const Tile& pixels : areas_of(job, tile)) {
    area.begin(job, pixels);
    if (!area.advance(job, job.samples.count, workspace.batch, traced)) break;
    area.resolve(job.frame, image);
  }
  return traced;
}

std::unique_ptr<TileWorkspace> WorkspacePool::take() {
  const std::scoped_lock lock(mutex_);
  if (idle_.empty()) {
    auto workspace = std::make_unique<TileWorkspace>();
    if (sampler_) workspace->batch.mark = sampler_->mark();
    return workspace;
  }
  std::unique_ptr<TileWorkspace> workspace = std::move(idle_.back());
  idle_.pop_back();
  return workspace;
}

void WorkspacePool::give_back(std::unique_ptr<TileWorkspace> workspace) {
  workspace->batch.mark.enter(Stage::kNone, 0);
  const std::scoped_lock lock(mutex_);
  idle_.push_back(std::move(workspace));
}

}  // namespace msbvh
