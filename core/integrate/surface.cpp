#include "core/integrate/surface.h"

#include <algorithm>

#include "core/integrate/looks.h"
#include "core/integrate/mesh_lights.h"
#include "core/plan/effect_variant.h"

namespace msbvh {
namespace {

// Hits ahead of the one at hand whose triangles, and whose vertices, are asked for from memory.
constexpr std::size_t kTrianglesAhead = 16, kVerticesAhead = 8;

template <EffectSet kGeometry>
void fetch_triangle(const Frame& frame, const Hit& hit) {
  if (!hit.found()) return;
  const HitSource source = frame.index.resolve<kGeometry>(hit);
  if (kGeometry == kPlain || source.mesh) __builtin_prefetch(&source.mesh->shape.triangles[hit.triangle]);
  if (kGeometry.has(Effect::kInstances) && source.instances)
    __builtin_prefetch(source.instance_controls().data());
}

template <EffectSet kGeometry>
void fetch_vertices(const Frame& frame, const Hit& hit, float shutter_time) {
  if (!hit.found()) return;
  const HitSource source = frame.index.resolve<kGeometry>(hit);
  if (kGeometry != kPlain && !source.mesh) return;
  const TriangleMesh& shape = source.mesh->shape;
  const SegmentTime at = locate(source.own_time<kGeometry>(shutter_time), shape.segments);
  const Vec3f* first = shape.control_positions(at.key * shape.degree);
  for (const std::uint32_t v : shape.triangles[hit.triangle]) __builtin_prefetch(first + v);
}

template <EffectSet kGeometry>
void find_surface(const Frame& frame, std::uint32_t place, PathBatch& batch) {
  const Hit& hit = batch.hits[place];
  batch.surfaces[place] =
      surface_at<kGeometry>(frame.scene(), frame.index.resolve<kGeometry>(hit), hit, batch.rays[place]);
}

// In the order of their materials, so that what a material reads stays in cache from one to the next.
template <EffectSet kGeometry>
void find_by_material(const Frame& frame, PathBatch& batch) {
  std::vector<std::uint64_t>& order = batch.by_material;
  order.clear();
  for (std::uint32_t place = 0; place < batch.active.size(); ++place) {
    const Hit& hit = batch.hits[place];
    if (hit.found())
      order.push_back(
          std::uint64_t(material_index<kGeometry>(frame.index.resolve<kGeometry>(hit), hit)) << 32 | place);
  }
  std::ranges::sort(order);
  for (const std::uint64_t entry : order)
    find_surface<kGeometry>(frame, static_cast<std::uint32_t>(entry), batch);
}

// Likewise, and everything that their materials say of them.
template <EffectSet kOn>
void find_looks(const Frame& frame, PathBatch& batch) {
  find_by_material<kKnownEffects>(frame, batch);
  choose_looks(frame, batch, batch.by_material, kOn.has(Effect::kSpecular));
  batch.mark.enter(Stage::kSurface, batch.depth);
}

// Out of line in every build, whichever variants call it.
template <EffectSet kGeometry>
[[gnu::noinline]] void find_all(const Frame& frame, PathBatch& batch) {
  if (frame.scene().materials.size() > 1) return find_by_material<kGeometry>(frame, batch);
  const std::size_t count = batch.active.size();
  for (std::size_t i = 0; i < std::min(kTrianglesAhead, count); ++i)
    fetch_triangle<kGeometry>(frame, batch.hits[i]);
  for (std::uint32_t place = 0; place < count; ++place) {
    if (place + kTrianglesAhead < count)
      fetch_triangle<kGeometry>(frame, batch.hits[place + kTrianglesAhead]);
    if (place + kVerticesAhead < count)
      fetch_vertices<kGeometry>(frame, batch.hits[place + kVerticesAhead],
                                batch.rays[place + kVerticesAhead].time);
    if (batch.hits[place].found()) find_surface<kGeometry>(frame, place, batch);
  }
}

template <EffectSet kGeometry, EffectSet kOn>
void find_surfaces(const Frame& frame, PathBatch& batch) {
  constexpr bool kDome = kOn.has(Effect::kDomeLight), kSpecular = kOn.has(Effect::kSpecular),
                 kImageDome = kOn.has(Effect::kImageDome);
  batch.mark.enter(Stage::kSurface, batch.depth);
  if constexpr (kSpecular || kOn.has(Effect::kTextures))
    find_looks<kOn>(frame, batch);
  else
    find_all<kGeometry>(frame, batch);
  if (batch.depth > 0 && frame.lights.has_meshes()) hide_met_meshes(frame, batch);
  batch.shaded.clear();
  batch.shaded_paths.clear();
  for (std::uint32_t place = 0; place < batch.active.size(); ++place) {
    const PathIndex path = batch.active[place];
    const Ray& ray = batch.rays[place];
    Vec3f& throughput = batch.throughput[path];
    if (!batch.hits[place].found()) {
      if (kDome && (batch.depth > 0 || frame.show_domes))
        batch.radiance[path] += throughput * frame.lights.dome_radiance(ray.time);
      // Later rays have found it as a light already.
      if (kImageDome && batch.depth == 0 && frame.show_domes)
        batch.radiance[path] += throughput * frame.lights.image_domes_radiance(ray.dir, ray.time);
      continue;
    }
    SurfaceHit& surface = batch.surfaces[place];
    if (batch.depth == 0) batch.alpha[path] = 1.0f;
    batch.radiance[path] += throughput * surface.emission;
    if constexpr (kSpecular) {
      if (surface.albedo == Vec3f{}) continue;
    } else {
      throughput = throughput * surface.albedo;
    }
    if (throughput == Vec3f{} || !clear_origin<kGeometry>(frame.surroundings(), ray, surface.origin))
      continue;
    batch.shaded.push_back(place);
    batch.shaded_paths.push_back(path);
  }
}

template <EffectSet kGeometry>
PathStage choose(EffectSet effects) {
  return variant_for<Effect::kDomeLight, Effect::kImageDome>(
      effects, []<EffectSet kOn>() -> PathStage { return find_surfaces<kGeometry, kOn>; });
}

}  // namespace

PathStage choose_surfaces(EffectSet effects, bool plain_geometry) {
  if ((effects.has(Effect::kSpecular) && kKnownEffects.has(Effect::kSpecular)) ||
      (effects.has(Effect::kTextures) && kKnownEffects.has(Effect::kTextures))) {
    return variant_for<Effect::kDomeLight, Effect::kImageDome, Effect::kSpecular, Effect::kTextures>(
        effects, []<EffectSet kOn>() -> PathStage { return find_surfaces<kKnownEffects, kOn>; });
  }
  return plain_geometry ? choose<kPlain>(effects) : choose<kKnownEffects>(effects);
}

}  // namespace msbvh
