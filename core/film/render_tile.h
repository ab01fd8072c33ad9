// The tile kernel: all samples of all pixels of a tile.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/film/film.h"
#include "core/plan/effect_plan.h"
#include "core/shade/integrator.h"

namespace msbvh {

// The same for all tiles of a frame.
struct TileJob {
  const FrameContext& frame;
  std::uint32_t width, height;  // of the image
  std::uint32_t spp;
  std::uint32_t seed;
  const std::atomic<bool>& cancelled;  // asked once for every sample of the whole tile
};

// Writes the tile's pixels into `rgba`, the whole image, [height][width][4]; returns the number of rays
// traced. Depends on nothing but its arguments, so that the image does not depend on who renders which tile.
// Leaves the pixels alone when cancelled.
using RenderTile = std::uint64_t (*)(const TileJob& job, const Tile& tile, float* rgba);

// The kernel without any code for the effects that `effects` does not contain. Chosen once a frame.
RenderTile choose_render_tile(EffectSet effects);

}  // namespace msbvh
