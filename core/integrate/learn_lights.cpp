#include "core/integrate/learn_lights.h"

#include <algorithm>
#include <vector>

#include "core/base/parallel.h"
#include "core/integrate/sampler.h"
#include "core/shade/camera.h"
#include "core/shade/light/light.h"
#include "core/shade/surface_hit.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr std::uint32_t kPilotColumns = 128, kPilotRows = 64;  // of paths, over the picture
constexpr std::uint32_t kPilotPaths = kPilotColumns * kPilotRows;
// To lights, at each of a path's surfaces: one for so many lights, within bounds.
constexpr std::size_t kLightsARay = 32;
constexpr std::size_t kFewestRays = 4, kMostRays = 32;
constexpr std::uint32_t kPilotDepth = 2;
constexpr std::uint32_t kPilotSeed = 0x11647u;
constexpr std::size_t kPathsATask = 64;

class Pilot {
 public:
  // It asks so many lights at each surface.
  Pilot(const Frame& frame, std::uint32_t path, std::size_t rays)
      : frame_(frame),
        rays_(rays),
        column_(path % kPilotColumns),
        row_(path / kPilotColumns),
        pixel_(kPilotSeed, column_, row_),
        sampler_(pixel_, 0) {}

  // `seen`: of each surface in its turn.
  void trace(std::uint32_t depths, SeenLight* seen) const {
    const Point2 in_pixel = pixel_.position(0);
    const float x = (float(column_) + in_pixel.x) / kPilotColumns,
                y = (float(row_) + in_pixel.y) / kPilotRows;
    Ray ray = camera_ray(frame_.scene().camera, x, y, pixel_.time(0));
    for (std::uint32_t depth = 0; depth < depths; ++depth) {
      Hit hit;
      if (!frame_.tracer.intersect(ray, hit)) return;
      const SurfaceHit surface = surface_at(frame_.scene(), frame_.index.resolve(hit), hit, ray);
      ask(surface, ray.time, depth, seen + depth * rays_);
      const Point2 random = sampler_.pair(Dimension::kBounce, depth);
      ray = leave(surface, Basis(surface.shading_normal)(sample_cosine_hemisphere(random)), ray.time);
    }
  }

 private:
  void ask(const SurfaceHit& surface, float time, std::uint32_t depth, SeenLight* seen) const {
    for (std::uint32_t i = 0; i < rays_; ++i) {
      const float random = sampler_.pair(Dimension::kLightPick, depth, i).x;
      const LightSampler::Tried tried =
          frame_.lights.try_light(random, surface.position, surface.shading_normal);
      if (!tried.pick) continue;
      LightSample sample;
      const LightPick& pick = *tried.pick;
      const Point2 place = sampler_.pair(Dimension::kLight, depth, i);
      const bool shines =
          pick.mesh ? pick.mesh->sample(surface, values_at(*pick.light, time), time, place, sample)
                    : sample_light(*pick.light, frame_.scene().camera, surface.position, time, place, sample);
      if (!shines || !(dot(sample.direction, surface.shading_normal) > 0.0f)) continue;
      Ray shadow = leave(surface, sample.direction, time);
      shadow.tfar = sample.distance;
      const bool hidden = pick.light->shadow.enabled && frame_.tracer.occluded(shadow);
      seen[i] = {surface.position, tried.light, true, !hidden};
    }
  }

  const Frame& frame_;
  const std::size_t rays_;
  const std::uint32_t column_, row_;
  const PixelSampler pixel_;
  const Sampler sampler_;
};

}  // namespace

void learn_lights(Frame& frame) {
  const std::size_t lights = frame.lights.placed_count();
  if (lights < kLearnFrom) return;
  const std::size_t asked = std::clamp(lights / kLightsARay, kFewestRays, kMostRays);
  const std::uint32_t depths = frame.max_bounces > 0 ? kPilotDepth : 1;
  std::vector<SeenLight> rays(std::size_t(kPilotPaths) * depths * asked);
  parallel_for_ranges(kPilotPaths, kPathsATask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t path = begin; path < end; ++path)
      Pilot(frame, std::uint32_t(path), asked).trace(depths, rays.data() + path * depths * asked);
  });
  frame.lights.learn(rays);
}

}  // namespace msbvh
