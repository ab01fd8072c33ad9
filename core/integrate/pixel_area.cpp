#include "core/integrate/pixel_area.h"

#include <algorithm>

#include "core/base/stopwatch.h"
#include "core/integrate/accumulate.h"
#include "core/integrate/clamp_indirect.h"
#include "core/integrate/shutter_slices.h"
#include "core/integrate/trace_paths.h"

namespace msbvh {
namespace {

// Colour, not alpha.
void expose(float exposure, float* rgba) {
  for (int channel = 0; channel < 3; ++channel) rgba[channel] *= exposure;
}

template <typename Body>
void for_pixels(const Tile& tile, const Image& image, const Body& body) {
  std::size_t in_tile = 0;
  for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::uint32_t x = tile.x0; x < tile.x1; ++x) body(in_tile++, std::size_t(y) * image.width + x);
  }
}

}  // namespace

void PixelArea::begin(const TileJob& job, const Tile& pixels) {
  pixels_ = pixels;
  taken_ = 0;
  clean_ = false;
  seconds_ = 0.0;
  const std::uint32_t count = pixels.pixels();
  sums_.reset(count);
  if (!job.frame.aovs.empty()) aov_sums_.reset(job.frame.aovs, count);
  slice_sums_.reset(std::size_t(count) * job.frame.shutter_slices);
  if (job.noise.decides()) noise_.reset(job.noise, count, job.frame.exposure);
}

bool PixelArea::advance(const TileJob& job, std::uint32_t count, PathBatch& batch, AreaTraced& traced) {
  if (!job.noise.decides()) return take(job, count - taken_, batch, traced);
  while (taken_ < count && !clean_) {
    const std::uint32_t judged_at = noise_.samples() + noise_.next_run();
    if (!take(job, std::min(judged_at, count) - taken_, batch, traced)) return false;
    if (taken_ == judged_at) judge();
  }
  return true;
}

void PixelArea::judge() {
  totals_.resize(pixels_.pixels());
  for (std::size_t pixel = 0; pixel < totals_.size(); ++pixel) totals_[pixel] = sums_.total(pixel);
  noise_.end_run(totals_);
  clean_ = noise_.reached();
}

bool PixelArea::take(const TileJob& job, std::uint32_t count, PathBatch& batch, AreaTraced& traced) {
  const Stages& stages = job.frame.stages;
  const Stopwatch watch;
  const std::uint32_t pixels = pixels_.pixels(), most = std::max(1u, job.batch_paths / pixels);
  const std::uint32_t slices = job.frame.shutter_slices;
  SampleRange samples{job.samples.first + taken_, 0};
  const std::uint32_t end = samples.first + count;
  for (; samples.first < end; samples.first += samples.count) {
    if (job.cancelled.load(std::memory_order_relaxed)) return false;
    samples.count = std::min(most, end - samples.first);
    stages.generate(job.frame, pixels_, samples, batch);
    stages.begin_aovs(job.frame, batch);
    if (slices > 0) begin_slices(slices, batch);
    if (job.frame.clamp_indirect > 0.0f)
      trace_clamped(job.frame, batch);
    else
      trace_paths(job.frame, batch);
    accumulate(batch, pixels, sums_);
    stages.accumulate(batch, pixels, samples.first, aov_sums_);
    if (slices > 0) accumulate_slices(batch, pixels, slices, slice_sums_);
    traced.rays += batch.traced;
    traced.samples += std::uint64_t(samples.count) * pixels;
  }
  taken_ += count;
  seconds_ += watch.seconds();
  return true;
}

void PixelArea::resolve(const Frame& frame, Image& image) const {
  for_pixels(pixels_, image, [&](std::size_t in_tile, std::size_t pixel) {
    sums_.total(in_tile).resolve(sums_.count(), &image.rgba[4 * pixel]);
    expose(frame.exposure, &image.rgba[4 * pixel]);
  });
  if (frame.shutter_slices > 0) resolve_slices(frame, image);
  if (image.aovs.empty()) return;
  for_pixels(pixels_, image, [&](std::size_t in_tile, std::size_t pixel) {
    AovTotals totals = aov_sums_.total(in_tile);
    totals.seconds = seconds_ / pixels_.pixels();
    totals.expose(frame.exposure);
    for (AovImage& aov : image.aovs) aov.set(pixel, totals);
  });
}

void PixelArea::resolve_slices(const Frame& frame, Image& image) const {
  const std::uint32_t slices = frame.shutter_slices;
  const std::size_t pixels = std::size_t(image.width) * image.height;
  for_pixels(pixels_, image, [&](std::size_t in_tile, std::size_t pixel) {
    for (std::size_t slice = 0; slice < slices; ++slice) {
      const FilmSum sum = slice_sums_.total(in_tile * slices + slice);
      float* rgba = &image.slices[4 * (slice * pixels + pixel)];
      sum.resolve(slice_sums_.count(), rgba);
      expose(frame.exposure, rgba);
    }
  });
}

void PixelArea::trim() {
  sums_.trim();
  aov_sums_.trim();
  slice_sums_.trim();
}

}  // namespace msbvh
