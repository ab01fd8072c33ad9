#include "core/cost/path_rays.h"

#include <algorithm>
#include <cmath>

#include "core/integrate/sampler.h"
#include "core/integrate/trace_paths.h"

namespace msbvh {
namespace {

// A pixel of cell `i` of `cells` along an edge of `pixels`; `random` in [0, 1).
std::uint32_t in_cell(std::uint32_t i, std::uint32_t cells, std::uint32_t pixels, float random) {
  const double at = (i + double(random)) * pixels / cells;
  return std::min(pixels - 1, static_cast<std::uint32_t>(at));
}

}  // namespace

SampledPaths::SampledPaths(std::uint32_t width, std::uint32_t height, std::uint32_t spp, std::uint32_t seed,
                           std::uint64_t count)
    : width_(width), height_(height), spp_(spp), seed_(seed), columns_(width), rows_(height) {
  const std::uint64_t pixels = std::uint64_t(width) * height;
  whole_ = count >= pixels;
  if (whole_) {
    samples_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(spp, count / pixels));
    return;
  }
  const double edge = std::sqrt(static_cast<double>(pixels) / static_cast<double>(count));  // of a cell
  const auto cells = [&](std::uint32_t along) {
    return std::clamp(static_cast<std::uint32_t>(std::lround(along / edge)), 1u, along);
  };
  columns_ = cells(width);
  rows_ = cells(height);
}

PathId SampledPaths::operator[](std::uint64_t i) const {
  const auto sample = static_cast<std::uint32_t>(i % samples_);
  const std::uint64_t cell = i / samples_;
  const auto column = static_cast<std::uint32_t>(cell % columns_);
  const auto row = static_cast<std::uint32_t>(cell / columns_);
  if (whole_) return {column, row, sample};
  const std::uint32_t key = hash(hash(hash(seed_), column), row);
  return {in_cell(column, columns_, width_, sobol::to_unit_float(hash(key, 0))),
          in_cell(row, rows_, height_, sobol::to_unit_float(hash(key, 1))), hash(key, 2) % spp_};
}

void add_path_rays(const Frame& frame, const PathId& path, PathBatch& batch, PathRays& rays) {
  const Tile pixel{path.x, path.y, path.x + 1, path.y + 1};
  frame.stages.generate(frame, pixel, {path.sample, 1}, batch);
  while (!batch.active.empty()) {
    batch.traced.log = batch.depth == 0 ? &rays.camera : &rays.bounce;
    meet_surfaces(frame, batch);
    batch.traced.log = &rays.shadow;
    light_surfaces(frame, batch);
  }
}

}  // namespace msbvh
