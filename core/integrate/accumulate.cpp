#include "core/integrate/accumulate.h"

namespace msbvh {

void accumulate(PathBatch& batch, std::uint32_t pixels, SumTrees<FilmSum>& sums) {
  batch.mark.enter(Stage::kAccumulate, 0);
  std::vector<PathIndex>& path_at = batch.path_at_slot;
  path_at.resize(batch.slot.size());
  for (PathIndex path = 0; path < batch.slot.size(); ++path) path_at[batch.slot[path]] = path;
  for (std::size_t slot = 0; slot < path_at.size();) {
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel, ++slot) {
      const PathIndex path = path_at[slot];
      sums.open(pixel) += FilmSample{batch.radiance[path], batch.alpha[path]};
    }
    sums.end_sample();
  }
}

void accumulate_aovs(PathBatch& batch, std::uint32_t pixels, std::uint32_t first, AovSums& sums) {
  batch.mark.enter(Stage::kAovs, 0);
  const std::vector<PathIndex>& path_at = batch.path_at_slot;
  for (std::size_t slot = 0; slot < path_at.size(); ++first) {
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel, ++slot) {
      const PathIndex path = path_at[slot];
      sums.add(pixel, first, batch.aovs[path]);
      if (sums.asked().light()) sums.add(pixel, batch.light[path]);
      if (sums.asked().cost()) sums.add(pixel, batch.costs[path]);
      if (sums.asked().has(Aov::kNoise)) sums.add(pixel, batch.radiance[path]);
      if (sums.asked().crypto()) sums.add(pixel, batch.crypto[path]);
    }
    sums.end_sample();
  }
}

}  // namespace msbvh
