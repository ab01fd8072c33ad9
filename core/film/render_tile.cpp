#include "core/film/render_tile.h"

#include <array>

#include "core/shade/camera.h"

namespace msbvh {
namespace {

template <EffectSet kEffects>
Ray sample_ray(const TileJob& job, const Sampler& sampler, float screen_x, float screen_y) {
  const Camera& camera = job.frame.index.scene().camera;
  const float time = sampler.time(job.spp);
  if constexpr (kEffects.has(Effect::kLens)) {
    return lens_ray(camera, screen_x, screen_y, time, sampler.pair(Dimension::kLens, 0));
  }
  return camera_ray(camera, screen_x, screen_y, time);
}

template <EffectSet kEffects>
PathResult render_sample(const TileJob& job, std::uint32_t x, std::uint32_t y, std::uint32_t sample,
                         std::uint64_t& rays) {
  const Sampler sampler(job.seed, x, y, sample);
  const Point2 in_pixel = sampler.pixel_position();
  const float screen_x = (static_cast<float>(x) + in_pixel.x) / static_cast<float>(job.width);
  const float screen_y = (static_cast<float>(y) + in_pixel.y) / static_cast<float>(job.height);
  PathTracer<kEffects.without(Effect::kLens)> path(job.frame, sampler);
  const PathResult result = path.trace(sample_ray<kEffects>(job, sampler, screen_x, screen_y));
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

// One kernel for every subset of the effects that change it.
template <EffectSet kChosen>
RenderTile choose(EffectSet) {
  return render_tile<kChosen>;
}
template <EffectSet kChosen, Effect kNext, Effect... kRest>
RenderTile choose(EffectSet effects) {
  return effects.has(kNext) ? choose<kChosen.with(kNext), kRest...>(effects)
                            : choose<kChosen, kRest...>(effects);
}

}  // namespace

RenderTile choose_render_tile(EffectSet effects) {
  return choose<EffectSet{}, Effect::kIndirectLight, Effect::kOpacity, Effect::kLens>(effects);
}

}  // namespace msbvh
