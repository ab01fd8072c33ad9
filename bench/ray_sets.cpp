#include "bench/ray_sets.h"

#include <cmath>

#include "bench/procedural.h"
#include "core/shade/camera.h"

namespace msbvh::bench {
namespace {

using procedural::Random;

// Bits 0, 2 and 4 of a place in a tile as a number: along the Z curve 16 neighbours are a square of 4 x 4,
// which packets trace better than two rows.
std::size_t every_second_bit(std::size_t place) { return (place & 1) | (place >> 1 & 2) | (place >> 2 & 4); }

std::vector<Ray> primary_rays(const Camera& camera, std::size_t count, Random& random) {
  constexpr std::size_t kTile = 8;
  const auto tiles = std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(double(count))) / kTile);
  const auto pixels = static_cast<float>(tiles * kTile);
  std::vector<Ray> rays;
  rays.reserve(tiles * tiles * kTile * kTile);
  for (std::size_t i = 0; i < tiles * tiles * kTile * kTile; ++i) {
    const std::size_t tile = i / (kTile * kTile), in_tile = i % (kTile * kTile);
    const auto x = static_cast<float>(tile % tiles * kTile + every_second_bit(in_tile)) + random.uniform();
    const auto y =
        static_cast<float>(tile / tiles * kTile + every_second_bit(in_tile >> 1)) + random.uniform();
    rays.push_back(camera_ray(camera, x / pixels, y / pixels, random.uniform()));
  }
  return rays;
}

// Above the scene; in a scene that the camera stands in, where the camera is, a little higher.
Vec3f light_position(const Camera& camera, const Box3f& bounds) {
  const Vec3f eye = camera_position(camera, 0.5f), extent = bounds.extent();
  if (bounds.contains(eye)) return eye + Vec3f{0.0f, 0.1f * extent.y, 0.0f};
  return bounds.center() + Vec3f{extent.x, 2.0f * extent.y, extent.z};
}

std::vector<Ray> shadow_rays(const std::vector<Ray>& primary, const Vec3f& light, float light_radius,
                             const Tracer& tracer, std::size_t count, Random& random) {
  std::vector<Ray> rays;
  bool any = true;
  while (any && rays.size() < count) {
    any = false;
    for (const Ray& ray : primary) {
      Hit hit;
      if (!tracer.intersect(ray, hit)) continue;
      any = true;
      Ray shadow;
      shadow.org = ray.org + ray.dir * (hit.t * (1.0f - 1e-4f));
      shadow.dir = light + random.direction() * light_radius - shadow.org;
      shadow.tnear = 1e-4f;
      shadow.tfar = 1.0f;
      shadow.time = ray.time;
      rays.push_back(shadow);
    }
  }
  return rays;
}

}  // namespace

const char* ray_kind_name(RayKind kind) {
  switch (kind) {
    case RayKind::kPrimary:
      return "primary";
    case RayKind::kShadow:
      return "shadow";
    case RayKind::kRandom:
      return "random";
  }
  return "unknown";
}

std::vector<Ray> make_rays(RayKind kind, const Scene& scene, const Box3f& bounds, const Tracer& tracer,
                           std::size_t count, std::uint32_t seed) {
  Random random(seed * 4ull + static_cast<std::uint64_t>(kind));
  if (kind == RayKind::kPrimary) return primary_rays(scene.camera, count, random);
  if (kind == RayKind::kShadow) {
    return shadow_rays(primary_rays(scene.camera, count, random), light_position(scene.camera, bounds),
                       0.02f * length(bounds.extent()), tracer, count, random);
  }
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.org = random.in_box(bounds.lo, bounds.hi);
    ray.dir = random.in_box(bounds.lo, bounds.hi) - ray.org;
    if (dot(ray.dir, ray.dir) == 0.0f) ray.dir = {0.0f, 0.0f, 1.0f};
    ray.time = random.uniform();
  }
  return rays;
}

std::vector<Ray> inside_rays(const Interior& interior, std::size_t count, std::uint32_t seed) {
  Random random(seed * 4ull + 3);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.org = interior.center + random.direction() * (interior.radius * random.uniform());
    ray.dir = random.direction();
    ray.time = random.uniform();
  }
  return rays;
}

}  // namespace msbvh::bench
