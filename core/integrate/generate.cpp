#include "core/integrate/generate.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/plan/effect_variant.h"
#include "core/shade/camera.h"

namespace msbvh {
namespace {

constexpr std::uint32_t kSquare = 4;  // pixels along the edge of those whose rays go in one packet

struct Pixel {
  std::uint16_t x, y;  // in the tile
};

// The pixels of a tile, square by square.
class PixelOrder {
 public:
  explicit PixelOrder(const Tile& tile) {
    const std::uint32_t width = tile.width(), height = tile.y1 - tile.y0;
    for (std::uint32_t y0 = 0; y0 < height; y0 += kSquare) {
      for (std::uint32_t x0 = 0; x0 < width; x0 += kSquare) {
        for (std::uint32_t y = y0; y < std::min(height, y0 + kSquare); ++y) {
          for (std::uint32_t x = x0; x < std::min(width, x0 + kSquare); ++x) {
            pixels_[count_++] = {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
          }
        }
      }
    }
  }
  const Pixel* begin() const { return pixels_.data(); }
  const Pixel* end() const { return pixels_.data() + count_; }

 private:
  std::array<Pixel, kTileSize * kTileSize> pixels_;
  std::size_t count_ = 0;
};

// Where the paths of each time stratum begin in the batch: a counting sort of all samples' times. As many
// strata as samples, so that a whole aligned power of two of them puts one sample of each pixel in each.
class TimeStrata {
 public:
  explicit TimeStrata(std::uint32_t samples) : count_(std::bit_ceil(samples)) {}

  void count(float time) { ++begin_[stratum(time) + 1]; }
  void sum_up() {
    for (std::uint32_t s = 1; s <= count_; ++s) begin_[s] += begin_[s - 1];
  }
  PathIndex take(float time) { return begin_[stratum(time)]++; }

 private:
  std::uint32_t stratum(float time) const {
    return static_cast<std::uint32_t>(time * static_cast<float>(count_));
  }
  std::uint32_t count_;
  std::array<PathIndex, kMaxBatchPaths + 1> begin_{};
};

// Where samples lie in their pixels and in the shutter.
enum class Spread : std::uint8_t { kEven, kShaped };

// Of the middle of a pixel's row, from the top of the rows rendered.
float row_share(const Frame& frame, std::uint32_t y) {
  return (static_cast<float>(y) + 0.5f) / static_cast<float>(frame.height);
}

// Sets batch.times, sample by sample of each pixel in turn. Out of line in every build, whichever variants
// call it.
template <Sampling kSampling, Spread kSpread>
[[gnu::noinline]] TimeStrata draw_times(const Frame& frame, const Tile& tile, const PixelOrder& pixels,
                                        SampleRange samples, PathBatch& batch) {
  TimeStrata strata(samples.count);
  float* time = batch.times.data();
  for (const Pixel& p : pixels) {
    const PixelSampler sampler(frame.seed, tile.x0 + p.x, tile.y0 + p.y);
    for (std::uint32_t s = 0; s < samples.count; ++s, ++time) {
      *time = sampler.time(sequence_index<kSampling>(sampler, samples.first + s));
      if constexpr (kSpread == Spread::kShaped) *time = frame.shutter(*time, row_share(frame, tile.y0 + p.y));
      strata.count(*time);
    }
  }
  strata.sum_up();
  return strata;
}

template <Spread kSpread>
PixelPlace place_in_pixel(const Frame& frame, const Point2& even) {
  if constexpr (kSpread == Spread::kShaped) return frame.filter(even);
  return {even.x, even.y};
}

template <EffectSet kOn, Sampling kSampling, Spread kSpread>
void generate(const Frame& frame, const Tile& tile, SampleRange samples, PathBatch& batch) {
  constexpr bool kLens = kOn.has(Effect::kLens), kMoving = kOn.has(Effect::kCameraMotion);
  batch.mark.enter(Stage::kGenerate, 0);
  const std::uint32_t pixels_in_tile = tile.pixels();
  batch.reset(std::size_t(samples.count) * pixels_in_tile);
  const PixelOrder pixels(tile);
  TimeStrata strata = draw_times<kSampling, kSpread>(frame, tile, pixels, samples, batch);
  const Camera& camera = frame.scene().camera;
  const CameraRays rays(camera);
  const auto width = static_cast<float>(frame.width), height = static_cast<float>(frame.height);
  const Draw on_lens(Dimension::kLens, 0);
  const float* time = batch.times.data();
  for (const Pixel& p : pixels) {
    const PixelSampler pixel(frame.seed, tile.x0 + p.x, tile.y0 + p.y);
    const auto x = static_cast<float>(tile.x0 + p.x), y = static_cast<float>(tile.y0 + p.y);
    std::uint32_t slot = p.y * tile.width() + p.x;
    for (std::uint32_t s = 0; s < samples.count; ++s, ++time, slot += pixels_in_tile) {
      const PathIndex path = strata.take(*time);
      const std::uint32_t index = sequence_index<kSampling>(pixel, samples.first + s);
      const Sampler sampler(pixel, index);
      const PixelPlace in_pixel = place_in_pixel<kSpread>(frame, pixel.position(index));
      const float screen_x = (x + in_pixel.x) / width, screen_y = (y + in_pixel.y) / height;
      batch.sampler[path] = sampler;
      batch.slot[path] = slot;
      batch.active[path] = path;
      batch.rays[path] = kLens     ? lens_ray(camera, screen_x, screen_y, *time, sampler.pair(on_lens))
                         : kMoving ? rays.ray(screen_x, screen_y, *time)
                                   : rays.still_ray(screen_x, screen_y, *time);
    }
  }
}

template <Sampling kSampling, Spread kSpread>
Generate choose(EffectSet effects) {
  return variant_for<Effect::kLens, Effect::kCameraMotion>(
      effects, []<EffectSet kOn>() -> Generate { return generate<kOn, kSampling, kSpread>; });
}

template <Spread kSpread>
Generate choose(EffectSet effects, Sampling sampling) {
  return sampling == Sampling::kSobol ? choose<Sampling::kSobol, kSpread>(effects)
                                      : choose<Sampling::kIndependent, kSpread>(effects);
}

}  // namespace

Generate choose_generate(EffectSet effects, Sampling sampling, bool shaped) {
  return shaped ? choose<Spread::kShaped>(effects, sampling) : choose<Spread::kEven>(effects, sampling);
}

}  // namespace msbvh
