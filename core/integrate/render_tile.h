// All samples of all pixels of a tile, by the stages of this folder.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/film/image.h"
#include "core/film/tile.h"
#include "core/integrate/pixel_area.h"
#include "core/integrate/stage_samples.h"

namespace msbvh {

// What a thread needs to render a tile.
struct TileWorkspace {
  PathBatch batch;
  PixelArea area;
};

// The parts of a tile that have numbers of samples of their own.
std::vector<Tile> areas_of(const TileJob& job, const Tile& tile);

// Writes the tile's pixels into the whole image; returns how many rays were traced.
// Depends on nothing but its arguments, so that the image does not depend on who renders which tile. Leaves
// the pixels alone when cancelled.
AreaTraced render_tile(const TileJob& job, const Tile& tile, TileWorkspace& workspace, Image& image);

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
