#include "core/integrate/direct.h"

#include "core/integrate/controlled_shadow.h"
#include "core/integrate/light_parts.h"
#include "core/integrate/mesh_lights.h"
#include "core/integrate/mis.h"
#include "core/integrate/shadow.h"
#include "core/integrate/special_variant.h"
#include "core/shade/light/light.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// One pick of every surface.
template <EffectSet kOn>
class DirectLight {
 public:
  DirectLight(const Frame& frame, PathBatch& batch, std::uint32_t which)
      : frame_(frame), batch_(batch), which_(which), which_light_(Dimension::kLightPick, batch.depth) {}

  // By a sample of the light: irradiance over pi, times the path's throughput.
  void sample(std::uint32_t place, Point2 random) const {
    const SurfaceHit& surface = batch_.surfaces[place];
    const PathIndex path = batch_.active[place];
    const float time = batch_.rays[place].time;
    const LightPick pick = picked(path, place);
    LightSample light;
    if (!illuminates(pick, place)) return;
    if (!sample_picked(pick, surface, time, random, light)) return;
    const float cosine = dot(light.direction, surface.shading_normal);
    if (!takes(place, cosine, dot(light.direction, surface.geometric_normal))) return;
    Vec3f throughput = batch_.throughput[path];
    float pdf = cosine * (1.0f / kPi), weight = pdf;  // the cosine over pi is both, of what is diffuse
    if constexpr (kSpecular) {
      const Bsdf::Value reflected = value_at(place, light.direction);
      const Bsdf::Value under = seen(reflected, light.diffuse, light.specular);
      throughput = throughput * under.both();
      note_share(under, path);
      pdf = reflected.pdf;
      weight = 1.0f;
    }
    if (kArea && light.pdf > 0.0f) weight *= power_heuristic(pick.expected * light.pdf, pdf);
    if constexpr (kControls && !kSpecular) weight *= light.diffuse;
    const Vec3f contribution = throughput * light.irradiance * (weight / pick.expected);
    if (!light.casts_shadow) {
      batch_.radiance[path] += contribution;
      return;
    }
    Ray shadow = leave(surface, light.direction, time);
    shadow.tfar = light.distance;
    add_shadow(pick, shadow, path, contribution);
  }

  // By the scattered ray, where it meets the light.
  void find(std::uint32_t place) const {
    const float pdf = batch_.scatter_pdf[place];
    const PathIndex path = batch_.active[place];
    const LightPick pick = picked(path, place);
    if (!(pdf > 0.0f) || !pick.extended || !illuminates(pick, place)) return;
    Ray shadow = batch_.scattered[place];
    LightAlong along;
    if (!find_picked(pick, batch_.surfaces[place].position, shadow, along)) return;
    float weight = power_heuristic(pdf, pick.expected * along.pdf) / pick.expected;
    if constexpr (kControls && !kSpecular) weight *= along.diffuse;
    shadow.tfar = along.distance;
    Vec3f throughput = batch_.throughput[path];
    if constexpr (kSpecular && kControls) {
      // What the ray carries, lobe by lobe.
      const Bsdf::Value reflected = value_at(place, shadow.dir);
      const Bsdf::Value under = seen(reflected, along.diffuse, along.specular);
      throughput = throughput * under.both() * (1.0f / pdf);
      note_share(under, path);
    } else if constexpr (kSpecular) {
      throughput = throughput * batch_.scatter_weight[place];
      if (splits_light()) batch_.light_share[path] = batch_.scattered_share[path];
    }
    add_shadow(pick, shadow, path, throughput * along.radiance * weight);
  }

 private:
  static constexpr bool kArea = kOn.has(Effect::kAreaLights), kMoving = kOn.has(Effect::kMovingLights),
                        kControls = kOn.has(Effect::kLightControls), kSpecular = kOn.has(Effect::kSpecular),
                        kSpecial = kOn.has(kSpecialLobes);

  // Whether light may come from a direction, by its cosines to both normals.
  bool takes(std::uint32_t place, float shading_cosine, float geometric_cosine) const {
    if constexpr (kSpecial) {
      if (is_special(batch_.special[place]))
        return takes_light(batch_.special[place], shading_cosine, geometric_cosine);
    }
    return shading_cosine > 0.0f && geometric_cosine > 0.0f;
  }

  Bsdf::Value value_at(std::uint32_t place, const Vec3f& direction) const {
    const Vec3f& normal = batch_.surfaces[place].shading_normal;
    if constexpr (kSpecial) return value_of(batch_.special[place], batch_.bsdfs[place], normal, direction);
    return batch_.bsdfs[place].at(normal, direction);
  }

  // Under a light that each kind of lobe may take more or less of.
  static Bsdf::Value seen(const Bsdf::Value& reflected, float diffuse, float specular) {
    if constexpr (!kControls) return reflected;
    return {reflected.diffuse * diffuse, reflected.specular * specular, reflected.pdf};
  }

  // For AOVs: what specular lobes of the first surface reflect of the light at hand.
  bool splits_light() const { return batch_.depth == 0 && !batch_.light.empty(); }
  void note_share(const Bsdf::Value& reflected, PathIndex path) const {
    if (splits_light()) batch_.light_share[path] = specular_share(reflected.specular, reflected.both());
  }

  bool illuminates(const LightPick& pick, std::uint32_t place) const {
    if constexpr (!kControls) return true;
    const std::vector<std::uint8_t>& groups = pick.light->lit_groups;
    return groups.empty() || groups[frame_.index.resolve(batch_.hits[place]).light_group()] != 0;
  }

  void add_shadow(const LightPick& pick, const Ray& ray, PathIndex path, const Vec3f& contribution) const {
    if constexpr (kControls) {
      if (frame_.lights.has_shadow_settings())
        return add_controlled_shadow(*pick.light, ray, path, contribution, batch_);
    }
    batch_.shadows.add(ray, path, contribution);
  }

  LightPick picked(PathIndex path, std::uint32_t place) const {
    const LightSampler& lights = frame_.lights;
    if (!lights.by_chance()) return lights.pick(which_);
    const SurfaceHit& surface = batch_.surfaces[place];
    Vec3f normal = surface.shading_normal;
    if constexpr (kSpecial) normal = lit_side(batch_.special[place], normal);
    return lights.pick(which_, batch_.sampler[path].pair(which_light_).x, surface.position, normal);
  }

  bool sample_picked(const LightPick& pick, const SurfaceHit& surface, float time, Point2 random,
                     LightSample& light) const {
    if constexpr (kArea && kControls) {
      if (pick.mesh) return sample_mesh(pick, surface, time, random, light);
    }
    const Vec3f& point = surface.position;
    const Camera& camera = frame_.scene().camera;
    return !kMoving || pick.still
               ? sample_light<kArea, kControls>(*pick.still, camera, point, time, random, light)
               : sample_light<kArea, kControls>(*pick.light, camera, point, time, random, light);
  }
  static bool sample_mesh(const LightPick& pick, const SurfaceHit& surface, float time, Point2 random,
                          LightSample& light) {
    return pick.still ? pick.mesh->sample(surface, pick.still->values, time, random, light)
                      : pick.mesh->sample(surface, values_at(*pick.light, time), time, random, light);
  }
  static bool find_picked(const LightPick& pick, const Vec3f& point, const Ray& ray, LightAlong& along) {
    return !kMoving || pick.still ? find_light<kControls>(*pick.still, point, ray.dir, along)
                                  : find_light<kControls>(*pick.light, point, ray.dir, ray.time, along);
  }

  const Frame& frame_;
  PathBatch& batch_;
  const std::uint32_t which_;
  const Draw which_light_;
};

template <EffectSet kOn>
void trace_light_shadows(const Frame& frame, PathBatch& batch) {
  if constexpr (kOn.has(Effect::kLightControls)) {
    if (frame.lights.has_shadow_settings()) return trace_controlled_shadows(frame, batch);
  }
  trace_shadows<shadow_effects(kOn)>(frame, batch);
}

// Of one ray to a light for each path, and what it says beside its light.
template <EffectSet kOn>
void trace_and_credit(const Frame& frame, PathBatch& batch) {
  trace_light_shadows<kOn>(frame, batch);
  if constexpr (kOn.has(Effect::kSpecular)) {
    if (batch.depth == 0 && !batch.light.empty()) credit_specular(batch, batch.light_share);
  }
}

template <EffectSet kOn>
void add_direct_light(const Frame& frame, PathBatch& batch) {
  for (std::uint32_t which = 0; which < frame.lights.picks(); ++which) {
    batch.mark.enter(Stage::kDirect, batch.depth);
    const DirectLight<kOn> light(frame, batch, which);
    batch.drawn.draw(batch.sampler, batch.shaded_paths, Draw(Dimension::kLight, batch.depth, which));
    for (std::size_t i = 0; i < batch.shaded.size(); ++i) light.sample(batch.shaded[i], batch.drawn[i]);
    trace_and_credit<kOn>(frame, batch);
    if constexpr (kOn.has(Effect::kAreaLights)) {
      batch.mark.enter(Stage::kAreaLights, batch.depth);
      for (const std::uint32_t place : batch.shaded) light.find(place);
      trace_and_credit<kOn>(frame, batch);
    }
  }
  if constexpr (kOn.has(Effect::kAreaLights) && kOn.has(Effect::kLightControls)) {
    if (frame.lights.has_meshes())
      add_met_meshes(frame, batch, kOn.has(Effect::kOpacity), kOn.has(Effect::kSpecular));
  }
}

}  // namespace

PathStage choose_direct(EffectSet effects) {
  return special_variant_for<Effect::kMovingLights, Effect::kAreaLights, Effect::kOpacity,
                             Effect::kLightControls, Effect::kTextures>(
      effects, []<EffectSet kOn>() -> PathStage { return add_direct_light<kOn>; });
}

}  // namespace msbvh
