#include "core/cost/path_rays.h"

#include <algorithm>
#include <cmath>

#include "core/integrate/generate.h"
#include "core/integrate/sampler.h"
#include "core/integrate/trace_paths.h"

namespace msbvh {
namespace {

std::vector<PathId> every_pixel(std::uint32_t width, std::uint32_t height, std::uint32_t samples) {
  std::vector<PathId> paths;
  paths.reserve(std::size_t(width) * height * samples);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      for (std::uint32_t sample = 0; sample < samples; ++sample) paths.push_back({x, y, sample});
    }
  }
  return paths;
}

// A pixel of cell `i` of `cells` along an edge of `pixels`; `random` in [0, 1).
std::uint32_t in_cell(std::uint32_t i, std::uint32_t cells, std::uint32_t pixels, float random) {
  const double at = (i + double(random)) * pixels / cells;
  return std::min(pixels - 1, static_cast<std::uint32_t>(at));
}

std::vector<PathId> one_a_cell(std::uint32_t width, std::uint32_t height, std::uint32_t spp,
                               std::uint32_t seed, double count) {
  const double edge = std::sqrt(double(width) * height / count);  // of a cell, pixels
  const auto cells = [&](std::uint32_t pixels) {
    return std::clamp(static_cast<std::uint32_t>(std::lround(pixels / edge)), 1u, pixels);
  };
  const std::uint32_t columns = cells(width), rows = cells(height);
  std::vector<PathId> paths;
  paths.reserve(std::size_t(columns) * rows);
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t key = hash(hash(hash(seed), column), row);
      paths.push_back({in_cell(column, columns, width, sobol::to_unit_float(hash(key, 0))),
                       in_cell(row, rows, height, sobol::to_unit_float(hash(key, 1))), hash(key, 2) % spp});
    }
  }
  return paths;
}

}  // namespace

std::vector<PathId> sampled_paths(std::uint32_t width, std::uint32_t height, std::uint32_t spp,
                                  std::uint32_t seed, std::uint64_t count) {
  const std::uint64_t pixels = std::uint64_t(width) * height;
  if (count < pixels) return one_a_cell(width, height, spp, seed, static_cast<double>(count));
  return every_pixel(width, height, static_cast<std::uint32_t>(std::min<std::uint64_t>(spp, count / pixels)));
}

void add_path_rays(const Frame& frame, EffectSet effects, const PathId& path, PathBatch& batch,
                   PathRays& rays) {
  const EffectSet traced = effects.without(Effect::kAovs);
  const Tile pixel{path.x, path.y, path.x + 1, path.y + 1};
  choose_generate(traced)(frame, pixel, {path.sample, 1}, batch);
  while (!batch.active.empty()) {
    batch.traced.log = batch.depth == 0 ? &rays.camera : &rays.bounce;
    meet_surfaces(frame, traced, batch);
    batch.traced.log = &rays.shadow;
    light_surfaces(frame, traced, batch);
  }
}

}  // namespace msbvh
