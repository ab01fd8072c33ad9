// Some pixels that have the same number of samples, and what has been summed up of those: a whole tile, or,
// where noise decides, one of its squares (core/film/noise_estimate.h). Samples come in as many goes as
// anybody likes.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/film/image.h"
#include "core/film/noise_estimate.h"
#include "core/film/sum_tree.h"
#include "core/film/tile.h"
#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// How a frame's samples are taken.
struct TileJob {
  const Frame& frame;
  SampleRange samples;
  std::uint32_t batch_paths;           // at most; 1 to kMaxBatchPaths. The picture does not depend on it
  const std::atomic<bool>& cancelled;  // asked before every batch
  NoiseGoal noise{};                   // where it decides, `samples` begin at 0 and their count is the most
};

// What tracing some pixels took.
struct AreaTraced {
  TraceModes rays;
  std::uint64_t samples = 0;  // summed over pixels

  AreaTraced& operator+=(const AreaTraced& b) {
    rays += b.rays;
    samples += b.samples;
    return *this;
  }
};

class PixelArea {
 public:
  // Forgets all samples. Memory is kept.
  void begin(const TileJob& job, const Tile& pixels);
  // Goes on until there are `count` of the job's samples, or there is no more noise than the goal's. False:
  // cancelled.
  bool advance(const TileJob& job, std::uint32_t count, PathBatch& batch, AreaTraced& traced);
  // Whether no more samples are wanted below the job's most.
  bool clean() const { return clean_; }
  // Into the whole image.
  void resolve(const Frame& frame, Image& image) const;
  // Gives back memory that the next samples do not need at once.
  void trim();

 private:
  bool take(const TileJob& job, std::uint32_t count, PathBatch& batch, AreaTraced& traced);
  void judge();
  void resolve_slices(const Frame& frame, Image& image) const;

  Tile pixels_{};
  std::uint32_t taken_ = 0;
  bool clean_ = false;
  double seconds_ = 0.0;
  SumTrees<FilmSum> sums_;
  AovSums aov_sums_;
  SumTrees<FilmSum> slice_sums_;
  NoiseEstimate noise_;
  std::vector<FilmSum> totals_;  // of judge()
};

}  // namespace msbvh
