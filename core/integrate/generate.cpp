#include "core/integrate/generate.h"

#include <algorithm>
#include <array>
#include <bit>

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

template <bool kLens>
Ray sample_ray(const Frame& frame, const Sampler& sampler, float screen_x, float screen_y, float time) {
  const Camera& camera = frame.scene().camera;
  if constexpr (kLens) return lens_ray(camera, screen_x, screen_y, time, sampler.pair(Dimension::kLens, 0));
  return camera_ray(camera, screen_x, screen_y, time);
}

template <bool kLens>
void generate(const Frame& frame, const Tile& tile, SampleRange samples, PathBatch& batch) {
  batch.reset(std::size_t(samples.count) * tile.pixels());
  const PixelOrder pixels(tile);
  const auto for_all = [&](const auto& body) {
    for (const Pixel& p : pixels) {
      const PixelSampler sampler(frame.seed, tile.x0 + p.x, tile.y0 + p.y);
      for (std::uint32_t s = 0; s < samples.count; ++s) body(p, sampler, s, sampler.time(samples.first + s));
    }
  };
  TimeStrata strata(samples.count);
  for_all([&](const Pixel&, const PixelSampler&, std::uint32_t, float time) { strata.count(time); });
  strata.sum_up();
  const auto width = static_cast<float>(frame.width), height = static_cast<float>(frame.height);
  for_all([&](const Pixel& p, const PixelSampler& pixel, std::uint32_t s, float time) {
    const PathIndex path = strata.take(time);
    const Point2 in_pixel = pixel.position(samples.first + s);
    batch.sampler[path] = Sampler(pixel, samples.first + s);
    batch.slot[path] = s * tile.pixels() + p.y * tile.width() + p.x;
    batch.active[path] = path;
    batch.rays[path] = sample_ray<kLens>(frame, batch.sampler[path],
                                         (static_cast<float>(tile.x0 + p.x) + in_pixel.x) / width,
                                         (static_cast<float>(tile.y0 + p.y) + in_pixel.y) / height, time);
  });
}

}  // namespace

Generate choose_generate(EffectSet effects) {
  return effects.has(Effect::kLens) ? generate<true> : generate<false>;
}

}  // namespace msbvh
