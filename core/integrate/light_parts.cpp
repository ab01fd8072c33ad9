#include "core/integrate/light_parts.h"

namespace msbvh {

void credit_specular(PathBatch& batch, std::span<const Vec3f> share) {
  for (std::size_t path = 0; path < batch.light.size(); ++path) {
    batch.specular[path] += (batch.radiance[path] - batch.credited[path]) * share[path];
    batch.credited[path] = batch.radiance[path];
  }
}

Vec3f specular_share(const Vec3f& specular, const Vec3f& all) {
  const auto share = [](float of, float whole) { return whole > 0.0f ? of / whole : 0.0f; };
  return {share(specular.x, all.x), share(specular.y, all.y), share(specular.z, all.z)};
}

void sort_light(PathBatch& batch, LightPath way) {
  credit_specular(batch, batch.scattered_share);
  for (std::size_t path = 0; path < batch.light.size(); ++path) {
    const Vec3f &all = batch.radiance[path], &specular = batch.specular[path];
    batch.light[path].add(way, all - batch.sorted[path], specular - batch.sorted_specular[path]);
    batch.sorted[path] = all;
    batch.sorted_specular[path] = specular;
  }
}

}  // namespace msbvh
