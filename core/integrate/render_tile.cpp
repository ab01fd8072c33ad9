#include "core/integrate/render_tile.h"

#include <algorithm>
#include <utility>

#include "core/integrate/accumulate.h"
#include "core/integrate/trace_paths.h"

namespace msbvh {
namespace {

template <typename Body>
void for_pixels(const Tile& tile, const Image& image, const Body& body) {
  std::size_t in_tile = 0;
  for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::uint32_t x = tile.x0; x < tile.x1; ++x) body(in_tile++, std::size_t(y) * image.width + x);
  }
}

void resolve(const Tile& tile, const TileWorkspace& workspace, Image& image) {
  const SumTrees<FilmSum>& sums = workspace.sums;
  for_pixels(tile, image, [&](std::size_t in_tile, std::size_t pixel) {
    sums.total(in_tile).resolve(sums.count(), &image.rgba[4 * pixel]);
  });
  if (image.aovs.empty()) return;
  for_pixels(tile, image, [&](std::size_t in_tile, std::size_t pixel) {
    const AovSum sum = workspace.aov_sums.total(in_tile);
    for (AovImage& aov : image.aovs) aov.set(pixel, sum, workspace.aov_sums.count());
  });
}

}  // namespace

TraceModes render_tile(const TileJob& job, const Tile& tile, TileWorkspace& workspace, Image& image) {
  const Stages& stages = job.frame.stages;
  const std::uint32_t pixels = tile.pixels(), most = std::max(1u, job.batch_paths / pixels);
  TraceModes traced;
  workspace.sums.reset(pixels);
  if (!image.aovs.empty()) workspace.aov_sums.reset(pixels);
  const std::uint32_t end = job.samples.first + job.samples.count;
  for (SampleRange samples{job.samples.first, 0}; samples.first < end; samples.first += samples.count) {
    if (job.cancelled.load(std::memory_order_relaxed)) return traced;
    samples.count = std::min(most, end - samples.first);
    stages.generate(job.frame, tile, samples, workspace.batch);
    trace_paths(job.frame, workspace.batch);
    accumulate(workspace.batch, pixels, workspace.sums);
    stages.accumulate(workspace.batch, pixels, samples.first, workspace.aov_sums);
    traced += workspace.batch.traced;
  }
  resolve(tile, workspace, image);
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
