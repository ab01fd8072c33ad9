// The path tracer one ray at a time: the oracle of core/integrate, which must draw the same picture to the
// bit.
//
// The estimator in the order in which a textbook has it, with no queue, no packet and no batch. It shares the
// surfaces, lights and samples with the renderer (they have tests of their own) and none of its stages.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/api/renderer.h"
#include "core/film/sum_tree.h"
#include "core/integrate/controlled_shadow.h"
#include "core/integrate/frame.h"
#include "core/integrate/mis.h"
#include "core/integrate/sampler.h"
#include "core/shade/camera.h"
#include "core/shade/light/light.h"
#include "core/shade/surface_hit.h"
#include "core/shade/warp.h"

namespace msbvh {

class ScalarPathTracer {
 public:
  explicit ScalarPathTracer(const Frame& frame) : frame_(frame) {}

  FilmSample trace(const Sampler& sampler, Ray ray) const {
    FilmSample result;
    Vec3f throughput{1.0f, 1.0f, 1.0f};
    for (std::uint32_t depth = 0;; ++depth) {
      SurfaceHit surface;
      std::uint32_t light_group = 0;
      if (!find_surface(sampler, ray, depth, surface, light_group)) {
        if (depth > 0 || frame_.show_domes)
          result.radiance += throughput * frame_.lights.dome_radiance(ray.time);
        if (depth == 0 && frame_.show_domes)
          result.radiance += throughput * frame_.lights.image_domes_radiance(ray.dir, ray.time);
        return result;
      }
      if (depth == 0) result.alpha = 1.0f;
      result.radiance += throughput * surface.emission;
      throughput = throughput * surface.albedo;
      if (throughput == Vec3f{} || !clear_origin(frame_.surroundings(), ray, surface.origin)) return result;
      add_direct_light(sampler, surface, light_group, throughput, ray.time, depth, result);
      float pdf;
      if (!bounce(sampler, surface, depth, ray, pdf) || !(pdf > 0.0f)) return result;
      if (depth == frame_.max_bounces) {
        if (frame_.lights.has_dome())
          result.radiance += dimmed(ray, throughput * frame_.lights.dome_radiance(ray.time));
        return result;
      }
    }
  }

 private:
  static void step_past(const Hit& hit, Ray& ray) {
    ray.tnear = std::nextafter(hit.t, std::numeric_limits<float>::infinity());
  }

  bool find_surface(const Sampler& sampler, Ray ray, std::uint32_t depth, SurfaceHit& surface,
                    std::uint32_t& light_group) const {
    Hit hit;
    for (std::uint32_t layer = 0; frame_.tracer.intersect(ray, hit); ++layer) {
      const HitSource source = frame_.index.resolve(hit);
      const float opacity = opacity_at(frame_.scene(), source, hit, ray.time);
      if (opacity < 1.0f && sampler.pair(Dimension::kOpacity, depth, layer).x >= opacity) {
        step_past(hit, ray);
        continue;
      }
      surface = surface_at(frame_.scene(), source, hit, ray);
      light_group = source.light_group();
      return true;
    }
    return false;
  }

  // What is left of `light` after all that the ray passes.
  Vec3f dimmed(Ray ray, Vec3f light) const {
    Hit hit;
    while (light != Vec3f{} && frame_.tracer.intersect(ray, hit)) {
      light = light * (1.0f - opacity_at(frame_.scene(), frame_.index.resolve(hit), hit, ray.time));
      step_past(hit, ray);
    }
    return light;
  }

  // What is left of light behind all that may shadow it: the textbook's product, unless the light says
  // otherwise.
  Vec3f reaching(const Light& light, Ray ray, const Vec3f& amount) const {
    if (!frame_.lights.has_shadow_settings()) return dimmed(ray, amount);
    if (!light.shadow.enabled) return amount;
    if (light.shadow.distance >= 0.0f) ray.tfar = std::min(ray.tfar, light.shadow.distance);
    Hit hit;
    float left = 1.0f, shadowed = 0.0f;
    while (left > 0.0f && frame_.tracer.intersect(ray, hit)) {
      const HitSource source = frame_.index.resolve(hit);
      if (holds_group(light.shadow_groups, source.light_group())) {
        const float absorbed = left * opacity_at(frame_.scene(), source, hit, ray.time);
        shadowed += absorbed * shadow_strength(light.shadow, hit.t);
        left -= absorbed;
      }
      step_past(hit, ray);
    }
    return shadowed_light(light.shadow, amount, shadowed);
  }

  void add_direct_light(const Sampler& sampler, const SurfaceHit& surface, std::uint32_t light_group,
                        const Vec3f& throughput, float time, std::uint32_t depth, FilmSample& result) const {
    const float random = sampler.pair(Dimension::kLightPick, depth).x;
    for (std::uint32_t i = 0; i < frame_.lights.picks(); ++i) {
      const LightPick pick = frame_.lights.pick(i, random, surface.position, surface.shading_normal);
      if (!holds_group(pick.light->lit_groups, light_group)) continue;
      result.radiance +=
          sampled_light(sampler.pair(Dimension::kLight, depth, i), surface, throughput, time, pick);
      if (pick.extended) result.radiance += met_light(sampler, surface, throughput, time, depth, pick);
    }
  }

  Vec3f sampled_light(Point2 random, const SurfaceHit& surface, const Vec3f& throughput, float time,
                      const LightPick& pick) const {
    LightSample light;
    if (!sample_light(*pick.light, frame_.scene().camera, surface.position, time, random, light)) return {};
    const float cosine = dot(light.direction, surface.shading_normal), pdf = cosine * (1.0f / kPi);
    if (cosine <= 0.0f || dot(light.direction, surface.geometric_normal) <= 0.0f) return {};
    const float share = light.pdf > 0.0f ? power_heuristic(pick.expected * light.pdf, pdf) : 1.0f;
    const Vec3f reflected = throughput * light.irradiance * (pdf * share * light.diffuse / pick.expected);
    Ray shadow = leave(surface, light.direction, time);
    shadow.tfar = light.distance;
    return light.casts_shadow ? reaching(*pick.light, shadow, reflected) : reflected;
  }

  Vec3f met_light(const Sampler& sampler, const SurfaceHit& surface, const Vec3f& throughput, float time,
                  std::uint32_t depth, const LightPick& pick) const {
    Ray ray;
    ray.time = time;
    float pdf;
    LightAlong along;
    if (!bounce(sampler, surface, depth, ray, pdf) || !(pdf > 0.0f)) return {};
    if (!find_light(*pick.light, surface.position, ray.dir, time, along)) return {};
    ray.tfar = along.distance;
    const float share = power_heuristic(pdf, pick.expected * along.pdf) / pick.expected;
    return reaching(*pick.light, ray, throughput * along.radiance * (share * along.diffuse));
  }

  static bool bounce(const Sampler& sampler, const SurfaceHit& surface, std::uint32_t depth, Ray& ray,
                     float& pdf) {
    const Vec3f local = sample_cosine_hemisphere(sampler.pair(Dimension::kBounce, depth));
    const Vec3f direction = Basis(surface.shading_normal)(local);
    pdf = local.z * (1.0f / kPi);
    if (dot(direction, surface.geometric_normal) <= 0.0f) return false;
    ray = leave(surface, direction, ray.time);
    return true;
  }

  const Frame& frame_;
};

inline Ray camera_sample_ray(const Frame& frame, const PixelSampler& pixel, std::uint32_t x, std::uint32_t y,
                             std::uint32_t sample) {
  const Camera& camera = frame.scene().camera;
  const Point2 in_pixel = pixel.position(sample);
  const float screen_x = (static_cast<float>(x) + in_pixel.x) / static_cast<float>(frame.width);
  const float screen_y = (static_cast<float>(y) + in_pixel.y) / static_cast<float>(frame.height);
  const bool lens =
      !camera.lens.empty() && std::ranges::any_of(camera.lens, [](const Lens& l) { return l.radius > 0.0f; });
  if (!lens) return camera_ray(camera, screen_x, screen_y, pixel.time(sample));
  return lens_ray(camera, screen_x, screen_y, pixel.time(sample),
                  Sampler(pixel, sample).pair(Dimension::kLens, 0));
}

// The picture that a Renderer with the same scene and settings must draw.
inline Image scalar_picture(const Frame& frame, std::uint32_t spp) {
  Image image{frame.width, frame.height, std::vector<float>(std::size_t(4) * frame.width * frame.height), {}};
  const ScalarPathTracer tracer(frame);
  SumTrees<FilmSum> sums;
  for (std::uint32_t y = 0; y < frame.height; ++y) {
    for (std::uint32_t x = 0; x < frame.width; ++x) {
      const PixelSampler pixel(frame.seed, x, y);
      sums.reset(1);
      for (std::uint32_t s = 0; s < spp; ++s) {
        sums.open(0) += tracer.trace(Sampler(pixel, s), camera_sample_ray(frame, pixel, x, y, s));
        sums.end_sample();
      }
      sums.total(0).resolve(spp, &image.rgba[4 * (std::size_t(y) * frame.width + x)]);
    }
  }
  return image;
}

}  // namespace msbvh
