#include "core/integrate/clamp_indirect.h"

#include <algorithm>

#include "core/integrate/trace_paths.h"

namespace msbvh {
namespace {

// Of what all paths have beyond `direct`.
void clamp(float most, PathBatch& batch) {
  for (std::size_t path = 0; path < batch.direct.size(); ++path) {
    const Vec3f &direct = batch.direct[path], indirect = batch.radiance[path] - direct;
    const float largest = std::max({indirect.x, indirect.y, indirect.z});
    if (!(largest > most)) continue;
    const float share = most / largest;
    batch.radiance[path] = direct + indirect * share;
    if (batch.light.empty()) continue;
    LightParts<float>& parts = batch.light[path];
    parts.indirect = parts.indirect * share;
    parts.indirect_specular = parts.indirect_specular * share;
  }
}

}  // namespace

void trace_clamped(const Frame& frame, PathBatch& batch) {
  meet_surfaces(frame, batch);
  light_surfaces(frame, batch);
  // What the scattered rays find is light that the first surface saw: direct.
  if (!batch.active.empty()) meet_surfaces(frame, batch);
  batch.direct.assign(batch.radiance.begin(), batch.radiance.begin() + std::ptrdiff_t(batch.slot.size()));
  if (!batch.active.empty()) light_surfaces(frame, batch);
  trace_paths(frame, batch);
  clamp(frame.clamp_indirect, batch);
}

}  // namespace msbvh
