#include "core/integrate/path_batch.h"

namespace msbvh {

void ShadowQueue::reserve(std::size_t most) {
  if (most <= rays_.size()) return;
  rays_.resize(most);
  path_.resize(most);
  contribution_.resize(most);
}

void PathBatch::reset(std::size_t paths) {
  sampler.resize(paths);
  slot.resize(paths);
  times.resize(paths);
  throughput.assign(paths, {1.0f, 1.0f, 1.0f});
  radiance.assign(paths, {});
  alpha.assign(paths, 0.0f);
  depth = 0;
  active.resize(paths);
  rays.resize(paths);
  hits.resize(paths);
  surfaces.resize(paths);
  shaded.clear();
  shaded_paths.clear();
  scattered.resize(paths);
  scatter_pdf.resize(paths);
  covers.clear();
  within.clear();
  shadows.clear();
  shadows.reserve(paths);
  traced = {};
}

}  // namespace msbvh
