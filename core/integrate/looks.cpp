#include "core/integrate/looks.h"

#include <algorithm>
#include <cmath>

#include "core/scene/opacity.h"
#include "core/shade/material/surface_values.h"

namespace msbvh {
namespace {

// Of a pixel's width, over which a texture is filtered: the pixel's own filter does the rest.
constexpr float kFootprint = 0.5f;
// Of the root of the solid angle that a scattered ray stands for. Many of them share the work.
constexpr float kScatteredFootprint = 0.125f;
// Nothing is worth filtering over more.
constexpr float kWidestSpread = 0.5f;

const Material& material_or_standard(const Scene& scene, std::uint32_t index) {
  static const Material standard{.name = {}, .diffuse_from_display_color = true};
  const Material* found = material_at(scene, index);
  return found ? *found : standard;
}

// The read of the texture that drives an input; none where none does.
std::optional<std::uint32_t> read_of(const Material& material, SurfaceInput input) {
  for (const DrivenInput& driven : material.driven) {
    if (driven.input == input && driven.source == DrivenInput::Source::kTexture) return driven.index;
  }
  return std::nullopt;
}

// Runs of the same material in such an order: body(material, first, last).
template <typename Body>
void by_material(const Scene& scene, std::span<const std::uint64_t> order, const Body& body) {
  for (std::size_t first = 0; first < order.size();) {
    const std::uint64_t material = order[first] >> 32;
    std::size_t last = first + 1;
    while (last < order.size() && order[last] >> 32 == material) ++last;
    body(material_or_standard(scene, static_cast<std::uint32_t>(material)),
         order.subspan(first, last - first));
    first = last;
  }
}

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

SurfaceLook apply_material(const Material& material, const HitSource& source, const Hit& hit, float time,
                           std::span<const TexelColor> texels,
                           const std::optional<TexturePlace>& normal_place, SurfaceHit& surface) {
  SurfaceValues values(material);
  values.diffuse_color = surface.albedo;  // which display colours may have set
  values.emissive_color = surface.emission;
  if (!material.driven.empty()) {
    drive(material, source, hit, time, texels, values);
    surface.emission = values.emissive_color;
    if (values.bent_normal && normal_place)
      surface.shading_normal = bent_normal(values.normal, surface.shading_normal, *normal_place);
  }
  const SurfaceLook look = look_of(material, values);
  surface.albedo = look.diffuse;
  return look;
}

void choose_looks(const Frame& frame, PathBatch& batch, std::span<const std::uint64_t> order, bool specular) {
  batch.mark.enter(Stage::kLooks, batch.depth);
  if (specular) {
    batch.bsdfs.resize(batch.slot.size());
    batch.scatter_weight.resize(batch.slot.size());
  }
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
    const std::optional<std::uint32_t> normal_read = read_of(material, SurfaceInput::kNormal);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const std::uint32_t place = static_cast<std::uint32_t>(run[i]);
      const Ray& ray = batch.rays[place];
      SurfaceHit& surface = batch.surfaces[place];
      const std::span<const TexelColor> texels =
          material.texture_reads.empty() ? std::span<const TexelColor>{} : reads.texels(i);
      const SurfaceLook look =
          apply_material(material, reads.hits[i].source, batch.hits[place], ray.time, texels,
                         normal_read ? reads.place(i, *normal_read) : std::nullopt, surface);
      if (!specular) continue;
      batch.bsdfs[place] = Bsdf(look, surface.shading_normal, normalize(-ray.dir));
      surface.albedo = batch.bsdfs[place].albedo();
    }
  });
}

void find_opacities(const Frame& frame, std::span<const Ray> rays, std::span<const Hit> hits,
                    std::span<const float> widths, MaterialReads& reads, std::vector<std::uint64_t>& order,
                    std::vector<float>& opacities) {
  const Scene& scene = frame.scene();
  opacities.resize(hits.size());
  order.clear();
  for (std::uint32_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].found()) continue;
    const HitSource source = frame.index.resolve(hits[i]);
    const std::uint32_t index = material_index(source, hits[i]);
    const Material* material = material_at(scene, index);
    if (drives_opacity(material))
      order.push_back(std::uint64_t(index) << 32 | i);
    else
      opacities[i] = opacity_at(scene, source, hits[i], rays[i].time);
  }
  std::ranges::sort(order);
  by_material(scene, order, [&](const Material& material, std::span<const std::uint64_t> run) {
    reads.hits.clear();
    for (const std::uint64_t entry : run) {
      const std::uint32_t i = static_cast<std::uint32_t>(entry);
      reads.hits.push_back(
          {frame.index.resolve(hits[i]), &hits[i], &rays[i], -normalize(rays[i].dir), widths[i]});
    }
    const std::optional<std::uint32_t> read = read_of(material, SurfaceInput::kOpacity);
    if (read) reads.read(*frame.textures, material, reads.hits, read);
    for (std::size_t k = 0; k < run.size(); ++k) {
      const std::uint32_t i = static_cast<std::uint32_t>(run[k]);
      const std::span<const TexelColor> texels = read ? reads.texels(k) : std::span<const TexelColor>{};
      opacities[i] = rendered_opacity(
          &material, driven_opacity(material, reads.hits[k].source, hits[i], rays[i].time, texels));
    }
  });
}

}  // namespace msbvh
