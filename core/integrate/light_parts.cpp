#include "core/integrate/light_parts.h"

namespace msbvh {

void sort_light(PathBatch& batch, LightPath way) {
  for (std::size_t path = 0; path < batch.light.size(); ++path) {
    const Vec3f &all = batch.radiance[path], &specular = batch.specular[path];
    batch.light[path].add(way, all - batch.sorted[path], specular - batch.sorted_specular[path]);
    batch.sorted[path] = all;
    batch.sorted_specular[path] = specular;
  }
}

}  // namespace msbvh
