#include "core/integrate/render_tile.h"

#include <algorithm>
#include <utility>

#include "core/base/stopwatch.h"
#include "core/integrate/accumulate.h"
#include "core/integrate/shutter_slices.h"
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

// Colour, not alpha.
void expose(float exposure, float* rgba) {
  for (int channel = 0; channel < 3; ++channel) rgba[channel] *= exposure;
}

// `seconds`: that a pixel took; read for the AOV of that name alone.
void resolve(const Tile& tile, const TileWorkspace& workspace, float exposure, double seconds, Image& image) {
  const SumTrees<FilmSum>& sums = workspace.sums;
  for_pixels(tile, image, [&](std::size_t in_tile, std::size_t pixel) {
    sums.total(in_tile).resolve(sums.count(), &image.rgba[4 * pixel]);
    expose(exposure, &image.rgba[4 * pixel]);
  });
  if (image.aovs.empty()) return;
  for_pixels(tile, image, [&](std::size_t in_tile, std::size_t pixel) {
    AovTotals totals = workspace.aov_sums.total(in_tile);
    totals.seconds = seconds;
    totals.expose(exposure);
    for (AovImage& aov : image.aovs) aov.set(pixel, totals);
  });
}

void resolve_slices(const Tile& tile, const TileWorkspace& workspace, const Frame& frame, Image& image) {
  const std::uint32_t slices = frame.shutter_slices;
  const std::size_t pixels = std::size_t(image.width) * image.height;
  for_pixels(tile, image, [&](std::size_t in_tile, std::size_t pixel) {
    for (std::size_t slice = 0; slice < slices; ++slice) {
      const FilmSum sum = workspace.slice_sums.total(in_tile * slices + slice);
      float* rgba = &image.slices[4 * (slice * pixels + pixel)];
      sum.resolve(workspace.slice_sums.count(), rgba);
      expose(frame.exposure, rgba);
    }
  });
}

TraceModes render_part(const TileJob& job, const Tile& tile, TileWorkspace& workspace, Image& image) {
  const Stages& stages = job.frame.stages;
  const Stopwatch watch;
  const std::uint32_t pixels = tile.pixels(), most = std::max(1u, job.batch_paths / pixels);
  TraceModes traced;
  workspace.sums.reset(pixels);
  if (!image.aovs.empty()) workspace.aov_sums.reset(job.frame.aovs, pixels);
  const std::uint32_t slices = job.frame.shutter_slices;
  workspace.slice_sums.reset(std::size_t(pixels) * slices);
  const std::uint32_t end = job.samples.first + job.samples.count;
  for (SampleRange samples{job.samples.first, 0}; samples.first < end; samples.first += samples.count) {
    if (job.cancelled.load(std::memory_order_relaxed)) return traced;
    samples.count = std::min(most, end - samples.first);
    stages.generate(job.frame, tile, samples, workspace.batch);
    stages.begin_aovs(job.frame, workspace.batch);
    if (slices > 0) begin_slices(slices, workspace.batch);
    trace_paths(job.frame, workspace.batch);
    accumulate(workspace.batch, pixels, workspace.sums);
    stages.accumulate(workspace.batch, pixels, samples.first, workspace.aov_sums);
    if (slices > 0) accumulate_slices(workspace.batch, pixels, slices, workspace.slice_sums);
    traced += workspace.batch.traced;
  }
  resolve(tile, workspace, job.frame.exposure, watch.seconds() / pixels, image);
  if (slices > 0) resolve_slices(tile, workspace, job.frame, image);
  return traced;
}

}  // namespace

TraceModes render_tile(const TileJob& job, const Tile& tile, TileWorkspace& workspace, Image& image) {
  if (!job.frame.aovs.has(Aov::kSeconds)) return render_part(job, tile, workspace, image);
  // Pixel by pixel: in a batch of many nobody can tell which took how long.
  TraceModes traced;
  for_pixels(tile, image, [&](std::size_t, std::size_t pixel) {
    const auto x = static_cast<std::uint32_t>(pixel % image.width),
               y = static_cast<std::uint32_t>(pixel / image.width);
    traced += render_part(job, {x, y, x + 1, y + 1}, workspace, image);
  });
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
