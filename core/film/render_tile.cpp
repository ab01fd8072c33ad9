#include "core/film/render_tile.h"

#include <array>

#include "core/shade/camera.h"

namespace msbvh {
namespace {

template <EffectSet kEffects>
PathResult render_sample(const TileJob& job, std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                         std::uint64_t& rays) {
  const Sampler sampler(job.seed, x, y, sample);
  const Point2 in_pixel = sampler.pixel_position();
  const float screen_x = (static_cast<float>(x) + in_pixel.x) / static_cast<float>(job.width);
  const float screen_y = (static_cast<float>(y) + in_pixel.y) / static_cast<float>(job.height);
  PathTracer<kEffects> path(job.frame, sampler);
  const PathResult result =
      path.trace(camera_ray(job.frame.index.scene().camera, screen_x, screen_y, sampler.time(job.spp)));
  rays += path.rays();
  return result;
}

// Sample by sample over the whole tile: sample s of every pixel lies in time stratum s, so that the rays that
// are traced together share a segment of the motion and read two keys of it.
template <EffectSet kEffects>
std::uint64_t render_tile(const TileJob& job, const Tile& tile, float* rgba) {
  std::array<PixelSum, kTileSize * kTileSize> sums;
  std::uint64_t rays = 0;
  for (std::uint32_t sample = 0; sample < job.spp; ++sample) {
    if (job.cancelled.load(std::memory_order_relaxed)) return rays;
    PixelSum* sum = sums.data();
    for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (std::uint32_t x = tile.x0; x < tile.x1; ++x) {
        (sum++)->add(render_sample<kEffects>(job, x, y, sample, rays));
      }
    }
  }
  const PixelSum* sum = sums.data();
  for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::uint32_t x = tile.x0; x < tile.x1; ++x) {
      (sum++)->resolve(job.spp, rgba + 4 * (std::size_t(y) * job.width + x));
    }
  }
  return rays;
}

}  // namespace

RenderTile choose_render_tile(EffectSet effects) {
  constexpr EffectSet kNothing{};
  constexpr EffectSet kOpaque = kNothing.with(Effect::kIndirectLight);
  constexpr EffectSet kDirect = kNothing.with(Effect::kOpacity);
  constexpr EffectSet kAll = kOpaque.with(Effect::kOpacity);
  if (effects.has(Effect::kIndirectLight)) {
    return effects.has(Effect::kOpacity) ? render_tile<kAll> : render_tile<kOpaque>;
  }
  return effects.has(Effect::kOpacity) ? render_tile<kDirect> : render_tile<kNothing>;
}

}  // namespace msbvh
