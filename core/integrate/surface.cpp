#include "core/integrate/surface.h"

#include <algorithm>

namespace msbvh {
namespace {

// Hits ahead of the one at hand whose triangles, and whose vertices, are asked for from memory.
constexpr std::size_t kTrianglesAhead = 16, kVerticesAhead = 8;

void fetch_triangle(const Frame& frame, const Hit& hit) {
  if (!hit.found()) return;
  const HitSource source = frame.index.resolve(hit);
  if (source.mesh) __builtin_prefetch(&source.mesh->shape.triangles[hit.triangle]);
  if (source.instances) __builtin_prefetch(source.instance_controls().data());
}

void fetch_vertices(const Frame& frame, const Hit& hit, float shutter_time) {
  if (!hit.found()) return;
  const HitSource source = frame.index.resolve(hit);
  if (!source.mesh) return;
  const TriangleMesh& shape = source.mesh->shape;
  const SegmentTime at = locate(source.own_time(shutter_time), shape.segments);
  const Vec3f* first = shape.control_positions(at.key * shape.degree);
  for (const std::uint32_t v : shape.triangles[hit.triangle]) __builtin_prefetch(first + v);
}

void find_surface(const Frame& frame, std::uint32_t place, PathBatch& batch) {
  const Hit& hit = batch.hits[place];
  batch.surfaces[place] = surface_at(frame.scene(), frame.index.resolve(hit), hit, batch.rays[place]);
}

// In the order of their materials, so that what a material reads stays in cache from one to the next.
void find_by_material(const Frame& frame, PathBatch& batch) {
  std::vector<std::uint64_t>& order = batch.by_material;
  order.clear();
  for (std::uint32_t place = 0; place < batch.active.size(); ++place) {
    const Hit& hit = batch.hits[place];
    if (hit.found())
      order.push_back(std::uint64_t(material_index(frame.index.resolve(hit), hit)) << 32 | place);
  }
  std::ranges::sort(order);
  for (const std::uint64_t entry : order) find_surface(frame, static_cast<std::uint32_t>(entry), batch);
}

void find_all(const Frame& frame, PathBatch& batch) {
  if (frame.scene().materials.size() > 1) return find_by_material(frame, batch);
  const std::size_t count = batch.active.size();
  for (std::size_t i = 0; i < std::min(kTrianglesAhead, count); ++i) fetch_triangle(frame, batch.hits[i]);
  for (std::uint32_t place = 0; place < count; ++place) {
    if (place + kTrianglesAhead < count) fetch_triangle(frame, batch.hits[place + kTrianglesAhead]);
    if (place + kVerticesAhead < count)
      fetch_vertices(frame, batch.hits[place + kVerticesAhead], batch.rays[place + kVerticesAhead].time);
    if (batch.hits[place].found()) find_surface(frame, place, batch);
  }
}

}  // namespace

void find_surfaces(const Frame& frame, PathBatch& batch) {
  find_all(frame, batch);
  batch.shaded.clear();
  batch.shaded_paths.clear();
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
    batch.shaded_paths.push_back(path);
  }
}

}  // namespace msbvh
