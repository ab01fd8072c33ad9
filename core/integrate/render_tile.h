// All samples of all pixels of a tile, by the stages of this folder.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/film/image.h"
#include "core/film/sum_tree.h"
#include "core/film/tile.h"
#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/integrate/stage_samples.h"

namespace msbvh {

struct TileJob {
  const Frame& frame;
  SampleRange samples;
  std::uint32_t batch_paths;           // at most; 1 to kMaxBatchPaths. The picture does not depend on it
  const std::atomic<bool>& cancelled;  // asked before every batch
};

// What a thread needs to render a tile.
struct TileWorkspace {
  PathBatch batch;
  SumTrees<FilmSum> sums;
  AovSums aov_sums;
  SumTrees<FilmSum> slice_sums;
};

// Writes the tile's pixels into the whole image; returns how many rays were traced.
// Depends on nothing but its arguments, so that the image does not depend on who renders which tile. Leaves
// the pixels alone when cancelled.
TraceModes render_tile(const TileJob& job, const Tile& tile, TileWorkspace& workspace, Image& image);

// Workspaces for as many threads as there turn out to be.
class WorkspacePool {
 public:
  // `sampler`: of what the threads do that hold workspaces; must outlive them. Null: nobody looks.
  explicit WorkspacePool(StageSampler* sampler = nullptr) : sampler_(sampler) {}
  std::unique_ptr<TileWorkspace> take();
  void give_back(std::unique_ptr<TileWorkspace> workspace);

 private:
  StageSampler* sampler_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<TileWorkspace>> idle_;
};

}  // namespace msbvh
