// A path tracer for diffuse surfaces: next-event estimation for every light that has a direction,
// cosine-sampled bounces for the dome, emissive surfaces and indirect light. Surfaces that are not opaque are
// seen or seen through by chance, shadow rays are dimmed by what they pass.
//
// Templated on the effects that change its loop. Effects that are off leave no code behind, and no random
// number of the others moves, since dimensions go by name.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/plan/effect_plan.h"
#include "core/shade/lights.h"
#include "core/shade/sampler.h"
#include "core/shade/scene_index.h"
#include "core/shade/surface.h"
#include "core/shade/warp.h"
#include "core/trace/tracer.h"

namespace msbvh {

// What paths read; the same for a whole frame. Thread-safe.
struct FrameContext {
  SceneIndex index;
  LightSet lights;
  const Bvh& world;  // that the tracer traces
  Tracer tracer;
  std::uint32_t max_bounces;  // 0: direct light only
  bool show_domes;            // camera rays that meet nothing see the dome
};

struct PathResult {
  Vec3f radiance;      // premultiplied
  float alpha = 0.0f;  // 1: a surface was seen, the dome is not one
};

template <EffectSet kEffects>
class PathTracer {
 public:
  PathTracer(const FrameContext& frame, const Sampler& sampler) : frame_(frame), sampler_(sampler) {}

  PathResult trace(Ray ray) {
    PathResult result;
    Vec3f throughput{1.0f, 1.0f, 1.0f};
    for (std::uint32_t depth = 0;; ++depth) {
      SurfacePoint surface;
      if (!find_surface(ray, depth, surface)) {
        if (depth > 0 || frame_.show_domes)
          result.radiance += throughput * frame_.lights.dome_radiance(ray.time);
        return result;
      }
      if (depth == 0) result.alpha = 1.0f;
      result.radiance += throughput * surface.emission;
      throughput = throughput * surface.albedo;
      if (throughput == Vec3f{} || !clear_origin(surroundings(), ray, surface.origin)) return result;
      result.radiance += throughput * direct_light(surface, ray.time, depth);
      if (!sample_bounce(surface, depth, ray)) return result;
      if (depth == max_bounces()) {
        if (frame_.lights.has_dome) {
          result.radiance += throughput * frame_.lights.dome_radiance(ray.time) * transmittance(ray);
        }
        return result;
      }
    }
  }

  // Rays traced so far: camera, bounce and shadow rays.
  std::uint64_t rays() const { return rays_; }

 private:
  static constexpr bool kOpacity = kEffects.has(Effect::kOpacity);

  Surroundings surroundings() const { return {frame_.index, frame_.world}; }
  std::uint32_t max_bounces() const { return kEffects.has(Effect::kIndirectLight) ? frame_.max_bounces : 0; }

  // The same ray cannot find the same triangle at the same distance again.
  static void step_past(const Hit& hit, Ray& ray) {
    ray.tnear = std::nextafter(hit.t, std::numeric_limits<float>::infinity());
  }

  bool find_surface(Ray ray, std::uint32_t depth, SurfacePoint& surface) {
    Hit hit;
    for (std::uint32_t layer = 0;; ++layer) {
      ++rays_;
      if (!frame_.tracer.intersect(ray, hit)) return false;
      const HitSource source = frame_.index.resolve(hit);
      if constexpr (kOpacity) {
        const float opacity = opacity_at(frame_.index.scene(), source, hit, ray.time);
        if (opacity < 1.0f && sampler_.pair(Dimension::kOpacity, depth, layer).x >= opacity) {
          step_past(hit, ray);
          continue;
        }
      }
      surface = surface_at(frame_.index.scene(), source, hit, ray);
      return true;
    }
  }

  // The share of light that passes along the ray.
  float transmittance(Ray ray) {
    ++rays_;
    if constexpr (!kOpacity) return frame_.tracer.occluded(ray) ? 0.0f : 1.0f;
    float share = 1.0f;
    Hit hit;
    while (share > 0.0f && frame_.tracer.intersect(ray, hit)) {
      share *= 1.0f - opacity_at(frame_.index.scene(), frame_.index.resolve(hit), hit, ray.time);
      step_past(hit, ray);
      ++rays_;
    }
    return share;
  }

  // Radiance reflected by a white surface from the lights that have a direction: irradiance over pi.
  Vec3f direct_light(const SurfacePoint& surface, float time, std::uint32_t depth) {
    Vec3f irradiance;
    const Camera& camera = frame_.index.scene().camera;
    for (std::uint32_t i = 0; i < frame_.lights.sampled.size(); ++i) {
      const Point2 random = sampler_.pair(Dimension::kLight, depth, i);
      LightSample light;
      if (!sample_light(*frame_.lights.sampled[i], camera, surface.position, time, random, light)) continue;
      const float cosine = dot(light.direction, surface.shading_normal);
      if (cosine <= 0.0f || dot(light.direction, surface.geometric_normal) <= 0.0f) continue;
      float visible = 1.0f;
      if (light.casts_shadow) {
        Ray shadow = leave(surface, light.direction, time);
        shadow.tfar = light.distance;
        visible = transmittance(shadow);
      }
      irradiance += light.irradiance * (cosine * visible);
    }
    return irradiance * (1.0f / kPi);
  }

  // The cosine and its density cancel. False where the shading normal leads the ray below the surface.
  bool sample_bounce(const SurfacePoint& surface, std::uint32_t depth, Ray& ray) {
    const Point2 random = sampler_.pair(Dimension::kBounce, depth);
    const Vec3f direction = Basis(surface.shading_normal)(sample_cosine_hemisphere(random));
    if (dot(direction, surface.geometric_normal) <= 0.0f) return false;
    ray = leave(surface, direction, ray.time);
    return true;
  }

  const FrameContext& frame_;
  const Sampler sampler_;
  std::uint64_t rays_ = 0;
};

}  // namespace msbvh
