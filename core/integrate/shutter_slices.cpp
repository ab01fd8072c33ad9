#include "core/integrate/shutter_slices.h"

#include <algorithm>

namespace msbvh {

void begin_slices(std::uint32_t slices, PathBatch& batch) {
  batch.shutter_slice.resize(batch.slot.size());
  for (std::size_t place = 0; place < batch.active.size(); ++place) {
    const float scaled = batch.rays[place].time * static_cast<float>(slices);  // exact: a power of two
    batch.shutter_slice[batch.active[place]] =
        static_cast<std::uint16_t>(std::min(static_cast<std::uint32_t>(scaled), slices - 1));
  }
}

void accumulate_slices(const PathBatch& batch, std::uint32_t pixels, std::uint32_t slices,
                       SumTrees<FilmSum>& sums) {
  const std::vector<PathIndex>& path_at = batch.path_at_slot;
  for (std::size_t slot = 0; slot < path_at.size();) {
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel, ++slot) {
      const PathIndex path = path_at[slot];
      sums.open(std::size_t(pixel) * slices + batch.shutter_slice[path]) +=
          FilmSample{batch.radiance[path], batch.alpha[path]};
    }
    sums.end_sample();
  }
}

}  // namespace msbvh
