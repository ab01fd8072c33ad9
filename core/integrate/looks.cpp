#include "core/integrate/looks.h"

#include <algorithm>
#include <cmath>

#include "core/scene/opacity.h"
#include "core/shade/material/surface_values.h"
#include "core/shade/round_surface.h"

namespace msbvh {
namespace {

// Of a pixel's width, over which a texture is filtered: the pixel's own filter does the rest.
constexpr float kFootprint = 0.5f;
// Of the root of the solid angle that a scattered ray stands for. Many of them share the work.
constexpr float kScatteredFootprint = 0.125f;
// Nothing is worth filtering over more.
constexpr float kWidestSpread = 0.5f;

}  // namespace

RayCone camera_cone(const Frame& frame, float time) {
  const Camera& camera = frame.scene().camera;
  const float place = time * float(camera.window.size() - 1);
  const ScreenWindow& window = camera.window[static_cast<std::size_t>(place)];
  const float width =
      frame.texture_rate * kFootprint * std::abs(window.right - window.left) / float(frame.width);
  return camera.projection == Projection::kOrthographic ? RayCone{width, 0.0f} : RayCone{0.0f, width};
}

RayCone scattered_cone(const Frame& frame, const RayCone& cone, float distance, float pdf) {
  const float spread = frame.texture_rate * kScatteredFootprint / std::sqrt(pdf);
  return {cone.width_at(distance), std::min(kWidestSpread, std::max(cone.spread, spread))};
}

void begin_cones(const Frame& frame, PathBatch& batch) {
  batch.cones.resize(batch.slot.size());
  batch.widths.resize(batch.slot.size());
  for (std::size_t place = 0; place < batch.active.size(); ++place)
    batch.cones[batch.active[place]] = camera_cone(frame, batch.rays[place].time);
}

const Material& material_or_standard(const Scene& scene, std::uint32_t index) {
  static const Material standard{.name = {}, .diffuse_from_display_color = true};
  const Material* found = material_at(scene, index);
  return found ? *found : standard;
}

std::optional<std::uint32_t> read_of(const Material& material, SurfaceInput input) {
  for (const DrivenInput& driven : material.driven) {
    if (driven.input == input && driven.source == DrivenInput::Source::kTexture) return driven.index;
  }
  return std::nullopt;
}

std::optional<TexturePlace> normal_place(const Material& material, const MaterialReads& reads, std::size_t i,
                                         const MaterialHit& hit) {
  if (const std::optional<std::uint32_t> read = read_of(material, SurfaceInput::kNormal))
    return reads.place(i, *read);
  if (material.normal_coordinates == kNoPrimvar) return std::nullopt;
  return texture_place(hit.source, *hit.hit, *hit.ray, material.normal_coordinates);
}

SurfaceLook apply_material(const Material& material, const HitSource& source, const Hit& hit, float time,
                           std::span<const TexelColor> texels,
                           const std::optional<TexturePlace>& normal_place, SurfaceHit& surface) {
  SurfaceValues values(material);
  values.diffuse_color = surface.albedo;  // which display colours may have set
  values.emissive_color = surface.emission;
  if (!material.driven.empty()) {
    drive(material, source, hit, time, texels, values);
    surface.emission = values.emissive_color;
  }
  if (values.bent_normal && normal_place)
    surface.shading_normal = bent_normal(values.normal, surface.shading_normal, *normal_place);
  const SurfaceLook look = look_of(material, values);
  surface.albedo = look.diffuse;
  return look;
}

SpecialLobe special_lobe(const HitSource& source, const Hit& hit, const Ray& ray, const SurfaceLook& look,
                         const Material& material, const SurfaceHit& surface, const Cover& cover,
                         bool within) {
  const Vec3f out = -normalize(ray.dir);
  if constexpr (kKnownEffects.has(Effect::kRefraction)) {
    if (cover.bends)
      return Glass(within ? 1.0f / look.ior : look.ior, look.alpha, surface.shading_normal, out);
  }
  if constexpr (kKnownEffects.has(Effect::kFibre)) {
    if (source.curves && source.curves->fibre) {
      FibreLook fibre;
      if (material.specular) {
        fibre.along = fibre.round = std::sqrt(look.alpha);
        fibre.ior = look.ior;
      }
      fibre.absorption = fibre_absorption(look.diffuse, fibre.round);
      return Fibre(fibre, curve_tangent(source, hit, ray), surface.shading_normal, out);
    }
  }
  return {};
}

namespace {

// Of all hits on one material, whose texels have been read to batch.reads.
class Looks {
 public:
  Looks(const Frame& frame, PathBatch& batch, bool specular)
      : frame_(frame), batch_(batch), specular_(specular) {}

  void choose(const Material& material, std::uint32_t place, std::size_t i) const {
    const Ray& ray = batch_.rays[place];
    const MaterialHit& hit = batch_.reads.hits[i];
    SurfaceHit& surface = batch_.surfaces[place];
    const std::span<const TexelColor> texels =
        material.texture_reads.empty() ? std::span<const TexelColor>{} : batch_.reads.texels(i);
    SurfaceLook look = apply_material(material, hit.source, *hit.hit, ray.time, texels,
                                      normal_place(material, batch_.reads, i, hit), surface);
    if (!specular_) return;
    const PathIndex path = batch_.active[place];
    Cover cover;
    if (!batch_.covers.empty()) {
      cover = batch_.covers[place];
      look.diffuse = look.diffuse * cover.diffuse;
      batch_.throughput[path] = batch_.throughput[path] * cover.weight;
    }
    batch_.bsdfs[place] = Bsdf(look, surface.shading_normal, normalize(-ray.dir));
    surface.albedo = batch_.bsdfs[place].albedo() * cover.weight;
    if (frame_.refraction || frame_.fibres) choose_special(material, place, hit, look, cover);
  }

 private:
  void choose_special(const Material& material, std::uint32_t place, const MaterialHit& hit,
                      const SurfaceLook& look, const Cover& cover) const {
    SurfaceHit& surface = batch_.surfaces[place];
    const bool within = frame_.refraction && batch_.within[batch_.active[place]] != 0;
    batch_.special[place] =
        special_lobe(hit.source, *hit.hit, *hit.ray, look, material, surface, cover, within);
    if (is_special(batch_.special[place]))
      surface.albedo = albedo_of(batch_.special[place], batch_.bsdfs[place]);
  }

  const Frame& frame_;
  PathBatch& batch_;
  const bool specular_;
};

void make_room(const Frame& frame, PathBatch& batch) {
  batch.bsdfs.resize(batch.slot.size());
  batch.scatter_weight.resize(batch.slot.size());
  if (frame.refraction || frame.fibres) batch.special.assign(batch.active.size(), {});
  if (frame.refraction) batch.within.resize(batch.slot.size());  // nobody is, at first
}

}  // namespace

void choose_looks(const Frame& frame, PathBatch& batch, std::span<const std::uint64_t> order, bool specular) {
  batch.mark.enter(Stage::kLooks, batch.depth);
  if (specular) make_room(frame, batch);
  const Looks looks(frame, batch, specular);
  by_material(frame.scene(), order, [&](const Material& material, std::span<const std::uint64_t> run) {
    MaterialReads& reads = batch.reads;
    reads.hits.clear();
    for (const std::uint64_t entry : run) {
      const std::uint32_t place = static_cast<std::uint32_t>(entry);
      const Hit& hit = batch.hits[place];
      const PathIndex path = batch.active[place];
      const float width = frame.textures ? batch.cones[path].width_at(hit.t) : 0.0f;
      if (frame.textures) batch.widths[path] = width;
      reads.hits.push_back({frame.index.resolve(hit), &hit, &batch.rays[place],
                            batch.surfaces[place].geometric_normal, width});
    }
    if (!material.texture_reads.empty()) reads.read(*frame.textures, material, reads.hits);
    for (std::size_t i = 0; i < run.size(); ++i)
      looks.choose(material, static_cast<std::uint32_t>(run[i]), i);
  });
}

}  // namespace msbvh
