// The path tracer one ray at a time: the oracle of core/integrate, which must draw the same picture to the
// bit.
//
// The estimator in the order in which a textbook has it, with no queue, no packet and no batch. It shares the
// surfaces, lights and samples with the renderer (they have tests of their own) and none of its stages.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/api/renderer.h"
#include "core/film/sum_tree.h"
#include "core/integrate/controlled_shadow.h"
#include "core/integrate/covers.h"
#include "core/integrate/frame.h"
#include "core/integrate/looks.h"
#include "core/integrate/mis.h"
#include "core/integrate/sampler.h"
#include "core/scene/opacity.h"
#include "core/shade/camera.h"
#include "core/shade/light/light.h"
#include "core/shade/material/surface_values.h"
#include "core/shade/surface_hit.h"
#include "core/shade/warp.h"

namespace msbvh {

class ScalarPathTracer {
 public:
  explicit ScalarPathTracer(const Frame& frame)
      : frame_(frame), effects_(plan_effects(frame.scene(), {.refraction = frame.refraction}).set) {}

  FilmSample trace(const Sampler& sampler, const Ray& ray) const {
    std::optional<Vec3f> direct;
    FilmSample result = path(sampler, ray, direct);
    const float most = frame_.clamp_indirect;
    if (!(most > 0.0f) || !direct) return result;
    const Vec3f indirect = result.radiance - *direct;
    const float largest = std::max({indirect.x, indirect.y, indirect.z});
    if (largest > most) result.radiance = *direct + indirect * (most / largest);
    return result;
  }

 private:
  // Sets `direct` to what there is of light before the first that is indirect, where any could be.
  FilmSample path(const Sampler& sampler, Ray ray, std::optional<Vec3f>& direct) const {
    FilmSample result;
    Vec3f throughput{1.0f, 1.0f, 1.0f};
    RayCone cone = camera_cone(frame_, ray.time);
    bool within = false;  // glass
    for (std::uint32_t depth = 0;; ++depth) {
      Vertex vertex;
      if (!find_surface(sampler, ray, depth, cone, within, vertex)) {
        if (depth > 0 || frame_.show_domes)
          result.radiance += throughput * frame_.lights.dome_radiance(ray.time);
        if (depth == 0 && frame_.show_domes)
          result.radiance += throughput * frame_.lights.image_domes_radiance(ray.dir, ray.time);
        return result;
      }
      SurfaceHit& surface = vertex.surface;
      if (depth == 0) result.alpha = 1.0f;
      throughput = throughput * vertex.cover.weight;
      if (depth > 0 && vertex.of_light) surface.emission = {};
      result.radiance += throughput * surface.emission;
      if (depth == 1) direct = result.radiance;
      if (!specular()) throughput = throughput * surface.albedo;
      if (throughput == Vec3f{} || surface.albedo == Vec3f{} ||
          !clear_origin(frame_.surroundings(), ray, surface.origin))
        return result;
      add_direct_light(sampler, vertex, throughput, ray.time, depth, result);
      Scattered next;
      if (!bounce(sampler, vertex, depth, ray, next) || !(next.pdf > 0.0f)) return result;
      if (specular()) throughput = throughput * next.weight;
      if (std::holds_alternative<Glass>(vertex.special) && dot(ray.dir, surface.geometric_normal) < 0.0f)
        within = !within;
      cone = scattered_cone(frame_, cone, vertex.distance, next.pdf);
      if (depth == frame_.max_bounces) {
        if (frame_.lights.has_dome())
          result.radiance += dimmed(ray, throughput * frame_.lights.dome_radiance(ray.time), vertex.width);
        return result;
      }
    }
  }

  // A surface on the way.
  struct Vertex {
    SurfaceHit surface;
    Bsdf bsdf;
    SpecialLobe special;
    Cover cover;
    float distance = 0.0f, width = 0.0f;  // of the ray that found it, and of its cone there
    std::uint32_t light_group = 0;
    bool of_light = false;  // on a mesh that shines
  };
  struct Scattered {
    float pdf = 0.0f;
    Vec3f weight;
  };

  Vec3f seen(const Bsdf::Value& reflected, float diffuse, float mirrored) const {
    return effects_.has(Effect::kLightControls) ? reflected.diffuse * diffuse + reflected.specular * mirrored
                                                : reflected.both();
  }

  static bool takes(const Vertex& vertex, const Vec3f& direction) {
    const SurfaceHit& surface = vertex.surface;
    return takes_light(vertex.special, dot(direction, surface.shading_normal),
                       dot(direction, surface.geometric_normal));
  }

  bool specular() const { return effects_.has(Effect::kSpecular); }

  static void step_past(const Hit& hit, Ray& ray) {
    ray.tnear = std::nextafter(hit.t, std::numeric_limits<float>::infinity());
  }

  Cover cover_of(const HitSource& source, const Hit& hit, const Ray& ray, float width) const {
    const Scene& scene = frame_.scene();
    const Material* material = material_at(scene, material_index(source, hit));
    const bool reflects = reflects_where_transparent(material);
    if (!drives_opacity(material) && !reflects) return {.chance = opacity_at(scene, source, hit, ray.time)};
    const MaterialHit one{source, &hit, &ray, -normalize(ray.dir), width};
    MaterialReads reads;
    if (frame_.textures) reads.read(*frame_.textures, *material, {&one, 1});
    const float opacity = drives_opacity(material)
                              ? rendered_opacity(material, driven_opacity(*material, source, hit, ray.time,
                                                                          texels_of(*material, reads)))
                              : opacity_at(scene, source, hit, ray.time);
    return opacity < 1.0f ? cover_at(frame_, *material, one, opacity, reads, 0) : Cover{.chance = opacity};
  }

  float shadow_of(const HitSource& source, const Hit& hit, const Ray& ray, float width) const {
    return shadow_share(cover_of(source, hit, ray, width));
  }

  static std::span<const TexelColor> texels_of(const Material& material, const MaterialReads& reads) {
    return material.texture_reads.empty() ? std::span<const TexelColor>{} : reads.texels(0);
  }

  bool find_surface(const Sampler& sampler, Ray ray, std::uint32_t depth, const RayCone& cone, bool within,
                    Vertex& vertex) const {
    Hit hit;
    for (std::uint32_t layer = 0; frame_.tracer.intersect(ray, hit); ++layer) {
      const HitSource source = frame_.index.resolve(hit);
      const float width = cone.width_at(hit.t);
      Cover cover = cover_of(source, hit, ray, width);
      const bool passes =
          cover.chance < 1.0f && sampler.pair(Dimension::kOpacity, depth, layer).x >= cover.chance;
      if (passes && !cover.bends) {
        step_past(hit, ray);
        continue;
      }
      cover.bends = passes;
      vertex = {
          surface_at(frame_.scene(), source, hit, ray), {}, {}, cover, hit.t, width, source.light_group(),
          frame_.lights.mesh_at(source) != nullptr};
      if (specular() || effects_.has(Effect::kTextures)) add_look(source, hit, ray, within, vertex);
      return true;
    }
    return false;
  }

  void add_look(const HitSource& source, const Hit& hit, const Ray& ray, bool within, Vertex& vertex) const {
    const Material& material = material_or_standard(frame_.scene(), material_index(source, hit));
    SurfaceHit& surface = vertex.surface;
    const MaterialHit one{source, &hit, &ray, surface.geometric_normal, vertex.width};
    MaterialReads reads;
    if (!material.texture_reads.empty()) reads.read(*frame_.textures, material, {&one, 1});
    SurfaceLook look = apply_material(material, source, hit, ray.time, texels_of(material, reads),
                                      normal_place(material, reads, 0, one), surface);
    if (!specular()) return;
    look.diffuse = look.diffuse * vertex.cover.diffuse;
    vertex.bsdf = Bsdf(look, surface.shading_normal, normalize(-ray.dir));
    vertex.special = special_lobe(source, hit, ray, look, material, surface, vertex.cover, within);
    surface.albedo = albedo_of(vertex.special, vertex.bsdf);
  }

  // What is left of `light` after all that the ray passes.
  Vec3f dimmed(Ray ray, Vec3f light, float width) const {
    Hit hit;
    while (light != Vec3f{} && frame_.tracer.intersect(ray, hit)) {
      light = light * (1.0f - shadow_of(frame_.index.resolve(hit), hit, ray, width));
      step_past(hit, ray);
    }
    return light;
  }

  // What is left of light behind all that may shadow it: the textbook's product, unless the light says
  // otherwise.
  Vec3f reaching(const Light& light, Ray ray, const Vec3f& amount, float width) const {
    if (!frame_.lights.has_shadow_settings()) return dimmed(ray, amount, width);
    if (!light.shadow.enabled) return amount;
    if (light.shadow.distance >= 0.0f) ray.tfar = std::min(ray.tfar, light.shadow.distance);
    Hit hit;
    float left = 1.0f, shadowed = 0.0f;
    while (left > 0.0f && frame_.tracer.intersect(ray, hit)) {
      const HitSource source = frame_.index.resolve(hit);
      if (holds_group(light.shadow_groups, source.light_group())) {
        const float absorbed = left * shadow_of(source, hit, ray, width);
        shadowed += absorbed * shadow_strength(light.shadow, hit.t);
        left -= absorbed;
      }
      step_past(hit, ray);
    }
    return shadowed_light(light.shadow, amount, shadowed);
  }

  void add_direct_light(const Sampler& sampler, const Vertex& vertex, const Vec3f& throughput, float time,
                        std::uint32_t depth, FilmSample& result) const {
    const float random = sampler.pair(Dimension::kLightPick, depth).x;
    for (std::uint32_t i = 0; i < frame_.lights.picks(); ++i) {
      const LightPick pick = frame_.lights.pick(i, random, vertex.surface.position,
                                                lit_side(vertex.special, vertex.surface.shading_normal));
      if (!holds_group(pick.light->lit_groups, vertex.light_group)) continue;
      result.radiance +=
          sampled_light(sampler.pair(Dimension::kLight, depth, i), vertex, throughput, time, pick);
      if (pick.extended) result.radiance += met_light(sampler, vertex, throughput, time, depth, pick);
    }
    if (frame_.lights.has_meshes()) add_met_meshes(sampler, vertex, throughput, time, depth, result);
  }

  void add_met_meshes(const Sampler& sampler, const Vertex& vertex, const Vec3f& throughput, float time,
                      std::uint32_t depth, FilmSample& result) const {
    Ray ray;
    ray.time = time;
    Scattered next;
    if (!bounce(sampler, vertex, depth, ray, next) || !(next.pdf > 0.0f)) return;
    Hit hit;
    for (float left = 1.0f; left > 0.0f && frame_.tracer.intersect(ray, hit); step_past(hit, ray)) {
      const HitSource source = frame_.index.resolve(hit);
      if (const LightPick* light = frame_.lights.mesh_at(source); light && light->mesh->is_met())
        result.radiance += met_mesh(*light, ray, hit, vertex, throughput, next.pdf, left);
      left *= 1.0f - shadow_of(source, hit, ray, vertex.width);
    }
  }

  Vec3f met_mesh(const LightPick& light, const Ray& ray, const Hit& hit, const Vertex& vertex,
                 const Vec3f& throughput, float pdf, float left) const {
    if (!holds_group(light.light->lit_groups, vertex.light_group)) return {};
    const SurfaceHit& surface = vertex.surface;
    const LightValues values = values_at(*light.light, ray.time);
    const float expected =
        frame_.lights.expected(light, surface.position, lit_side(vertex.special, surface.shading_normal));
    const float share = power_heuristic(pdf, expected * light.mesh->pdf(ray.dir, hit, ray.time)) * left;
    Vec3f carried = throughput * values.diffuse;
    if (specular()) {
      carried = throughput *
                seen(value_of(vertex.special, vertex.bsdf, surface.shading_normal, ray.dir), values.diffuse,
                     values.specular) *
                (1.0f / pdf);
    }
    return carried * values.radiance * share;
  }

  bool sample(const LightPick& pick, const SurfaceHit& surface, float time, Point2 random,
              LightSample& light) const {
    if (pick.mesh) return pick.mesh->sample(surface, values_at(*pick.light, time), time, random, light);
    return sample_light(*pick.light, frame_.scene().camera, surface.position, time, random, light);
  }

  Vec3f sampled_light(Point2 random, const Vertex& vertex, const Vec3f& throughput, float time,
                      const LightPick& pick) const {
    const SurfaceHit& surface = vertex.surface;
    LightSample light;
    if (!sample(pick, surface, time, random, light)) return {};
    const float cosine = dot(light.direction, surface.shading_normal);
    if (!takes(vertex, light.direction)) return {};
    Vec3f carried = throughput;
    float pdf = cosine * (1.0f / kPi), weight = pdf;
    if (specular()) {
      const Bsdf::Value reflected =
          value_of(vertex.special, vertex.bsdf, surface.shading_normal, light.direction);
      carried = throughput * seen(reflected, light.diffuse, light.specular);
      pdf = reflected.pdf;
      weight = 1.0f;
    }
    if (light.pdf > 0.0f) weight *= power_heuristic(pick.expected * light.pdf, pdf);
    if (!specular()) weight *= light.diffuse;
    const Vec3f reflected = carried * light.irradiance * (weight / pick.expected);
    Ray shadow = leave(surface, light.direction, time);
    shadow.tfar = light.distance;
    return light.casts_shadow ? reaching(*pick.light, shadow, reflected, vertex.width) : reflected;
  }

  Vec3f met_light(const Sampler& sampler, const Vertex& vertex, const Vec3f& throughput, float time,
                  std::uint32_t depth, const LightPick& pick) const {
    Ray ray;
    ray.time = time;
    Scattered next;
    LightAlong along;
    if (!bounce(sampler, vertex, depth, ray, next) || !(next.pdf > 0.0f)) return {};
    if (!find_light(*pick.light, vertex.surface.position, ray.dir, time, along)) return {};
    ray.tfar = along.distance;
    float share = power_heuristic(next.pdf, pick.expected * along.pdf) / pick.expected;
    Vec3f carried = throughput;
    if (specular() && effects_.has(Effect::kLightControls)) {
      const SurfaceHit& surface = vertex.surface;
      carried = throughput *
                seen(value_of(vertex.special, vertex.bsdf, surface.shading_normal, ray.dir), along.diffuse,
                     along.specular) *
                (1.0f / next.pdf);
    } else if (specular()) {
      carried = throughput * next.weight;
    } else {
      share *= along.diffuse;
    }
    return reaching(*pick.light, ray, carried * along.radiance * share, vertex.width);
  }

  bool bounce(const Sampler& sampler, const Vertex& vertex, std::uint32_t depth, Ray& ray,
              Scattered& next) const {
    const SurfaceHit& surface = vertex.surface;
    const Point2 random = sampler.pair(Dimension::kBounce, depth);
    Vec3f direction;
    if (specular()) {
      const BsdfSample sample = sample_of(vertex.special, vertex.bsdf, surface.shading_normal,
                                          sampler.pair(Dimension::kLobe, depth).x, random);
      direction = sample.direction;
      next = {sample.pdf, sample.weight};
    } else {
      const Vec3f local = sample_cosine_hemisphere(random);
      direction = Basis(surface.shading_normal)(local);
      next.pdf = local.z * (1.0f / kPi);
    }
    const bool leads_on = is_special(vertex.special) ? takes(vertex, direction)
                                                     : dot(direction, surface.geometric_normal) > 0.0f;
    if (!leads_on) return false;
    ray = leave(surface, direction, ray.time);
    return true;
  }

  const Frame& frame_;
  const EffectSet effects_;
};

inline Ray camera_sample_ray(const Frame& frame, const PixelSampler& pixel, std::uint32_t x, std::uint32_t y,
                             std::uint32_t sample) {
  const Camera& camera = frame.scene().camera;
  const PixelPlace in_pixel = frame.filter(pixel.position(sample));
  const float row = (static_cast<float>(y) + 0.5f) / static_cast<float>(frame.height);
  const float time = frame.shutter(pixel.time(sample), row);
  const float screen_x = (static_cast<float>(x) + in_pixel.x) / static_cast<float>(frame.width);
  const float screen_y = (static_cast<float>(y) + in_pixel.y) / static_cast<float>(frame.height);
  const bool lens =
      !camera.lens.empty() && std::ranges::any_of(camera.lens, [](const Lens& l) { return l.radius > 0.0f; });
  if (!lens) return camera_ray(camera, screen_x, screen_y, time);
  return lens_ray(camera, screen_x, screen_y, time, Sampler(pixel, sample).pair(Dimension::kLens, 0));
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
