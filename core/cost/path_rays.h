// The rays of a frame's own paths, traced again.
#pragma once

#include <cstdint>

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/trace/ray_log.h"

namespace msbvh {

// A camera sample of a frame.
struct PathId {
  std::uint32_t x, y;    // pixel
  std::uint32_t sample;  // of that pixel
};

// About `count` of the frame's width * height * spp paths, spread evenly over the image. As many as pixels
// and more: `count` over the pixels of each, rounded down, from its first sample on. Fewer: one in each of
// equal cells of the image, the pixel and the sample in it by a hash of `seed`.
class SampledPaths {
 public:
  // All at least 1.
  SampledPaths(std::uint32_t width, std::uint32_t height, std::uint32_t spp, std::uint32_t seed,
               std::uint64_t count);

  std::uint64_t size() const { return std::uint64_t(columns_) * rows_ * samples_; }
  PathId operator[](std::uint64_t i) const;

 private:
  std::uint32_t width_, height_, spp_, seed_;
  std::uint32_t columns_, rows_;  // of cells
  std::uint32_t samples_ = 1;     // of each
  bool whole_;                    // every cell is a pixel
};

// As the frame traces them, those that go on through what is not opaque included.
struct PathRays {
  RayLog camera;
  RayLog bounce;
  RayLog shadow;

  void clear() {
    camera.clear();
    bounce.clear();
    shadow.clear();
  }
};

// Adds the path's to `rays`. `frame` is a frame whose tracer logs (Tracer::logging); `batch` is of no matter
// before and after.
void add_path_rays(const Frame& frame, const PathId& path, PathBatch& batch, PathRays& rays);

}  // namespace msbvh
