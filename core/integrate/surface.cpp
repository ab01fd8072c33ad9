#include "core/integrate/surface.h"

#include <algorithm>

namespace msbvh {
namespace {

// Hits in the order of their materials, so that what a material reads stays in cache from one to the next.
void order_by_material(const Frame& frame, PathBatch& batch) {
  const Scene& scene = frame.scene();
  std::vector<std::uint64_t>& order = batch.by_material;
  order.clear();
  for (std::uint32_t place = 0; place < batch.active.size(); ++place) {
    const Hit& hit = batch.hits[place];
    if (!hit.found()) continue;
    const std::uint64_t material =
        scene.materials.size() > 1 ? material_index(frame.index.resolve(hit), hit) : 0;
    order.push_back(material << 32 | place);
  }
  if (scene.materials.size() > 1) std::ranges::sort(order);
}

}  // namespace

void find_surfaces(const Frame& frame, PathBatch& batch) {
  order_by_material(frame, batch);
  for (const std::uint64_t entry : batch.by_material) {
    const auto place = static_cast<std::uint32_t>(entry);
    const Hit& hit = batch.hits[place];
    batch.surfaces[place] = surface_at(frame.scene(), frame.index.resolve(hit), hit, batch.rays[place]);
  }
  batch.shaded.clear();
  for (std::uint32_t place = 0; place < batch.active.size(); ++place) {
    const PathIndex path = batch.active[place];
    const Ray& ray = batch.rays[place];
    Vec3f& throughput = batch.throughput[path];
    if (!batch.hits[place].found()) {
      if (batch.depth > 0 || frame.show_domes)
        batch.radiance[path] += throughput * frame.lights.dome_radiance(ray.time);
      continue;
    }
    SurfaceHit& surface = batch.surfaces[place];
    if (batch.depth == 0) batch.alpha[path] = 1.0f;
    batch.radiance[path] += throughput * surface.emission;
    throughput = throughput * surface.albedo;
    if (throughput == Vec3f{} || !clear_origin(frame.surroundings(), ray, surface.origin)) continue;
    batch.shaded.push_back(place);
  }
}

}  // namespace msbvh
