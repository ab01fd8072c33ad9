#include "core/integrate/covers.h"

#include <algorithm>

#include "core/integrate/looks.h"
#include "core/scene/opacity.h"
#include "core/shade/material/surface_values.h"

namespace msbvh {
namespace {

// Those that driven_opacity() of a material reads: its own texture alone, unless it reflects.
std::optional<std::uint32_t> read_for_opacity(const Material& material) {
  return read_of(material, SurfaceInput::kOpacity);
}

std::span<const TexelColor> texels_of(const Material& material, const MaterialReads& reads, std::size_t i) {
  return material.texture_reads.empty() ? std::span<const TexelColor>{} : reads.texels(i);
}

// Of hits on one material. `covers` holds the opacities of those that nothing but display values drives.
void cover_run(const Frame& frame, const Material& material, std::span<const std::uint64_t> run,
               MaterialReads& reads, std::vector<Cover>& covers) {
  const bool reflects = reflects_where_transparent(&material), driven = drives_opacity(&material);
  const std::optional<std::uint32_t> opacity_read = read_for_opacity(material);
  const bool reads_texels = reflects ? !material.texture_reads.empty() : opacity_read.has_value();
  if (reads_texels) reads.read(*frame.textures, material, reads.hits, reflects ? std::nullopt : opacity_read);
  for (std::size_t k = 0; k < run.size(); ++k) {
    Cover& cover = covers[static_cast<std::uint32_t>(run[k])];
    const MaterialHit& hit = reads.hits[k];
    const std::span<const TexelColor> texels =
        reads_texels ? texels_of(material, reads, k) : std::span<const TexelColor>{};
    if (driven) {
      cover.chance =
          rendered_opacity(&material, driven_opacity(material, hit.source, *hit.hit, hit.ray->time, texels));
    }
    if (reflects && cover.chance < 1.0f) cover = cover_at(frame, material, hit, cover.chance, reads, k);
  }
}

}  // namespace

Cover cover_at(const Frame& frame, const Material& material, const MaterialHit& hit, float opacity,
               const MaterialReads& reads, std::size_t i) {
  // All of a hair's light fades with its opacity, and a hair bends none.
  const bool hair = hit.source.curves && hit.source.curves->fibre;
  if (hair || !reflects_where_transparent(&material)) return {.chance = opacity};
  SurfaceHit surface = surface_at(frame.scene(), hit.source, *hit.hit, *hit.ray);
  const SurfaceLook look =
      apply_material(material, hit.source, *hit.hit, hit.ray->time, texels_of(material, reads, i),
                     normal_place(material, reads, i, hit), surface);
  const Vec3f out = -normalize(hit.ray->dir);
  return frame.refraction ? refracting_cover(look, opacity, surface.shading_normal, out)
                          : transparent_cover(look, opacity, surface.shading_normal, out);
}

void find_covers(const Frame& frame, std::span<const Ray> rays, std::span<const Hit> hits,
                 std::span<const float> widths, MaterialReads& reads, std::vector<std::uint64_t>& order,
                 std::vector<Cover>& covers) {
  const Scene& scene = frame.scene();
  covers.assign(hits.size(), {});
  order.clear();
  for (std::uint32_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].found()) continue;
    const HitSource source = frame.index.resolve(hits[i]);
    const std::uint32_t index = material_index(source, hits[i]);
    const Material* material = material_at(scene, index);
    bool looked_at = drives_opacity(material);
    if (!looked_at) {
      covers[i].chance = opacity_at(scene, source, hits[i], rays[i].time);
      looked_at = covers[i].chance < 1.0f && reflects_where_transparent(material);
    }
    if (looked_at) order.push_back(std::uint64_t(index) << 32 | i);
  }
  std::ranges::sort(order);
  by_material(scene, order, [&](const Material& material, std::span<const std::uint64_t> run) {
    reads.hits.clear();
    for (const std::uint64_t entry : run) {
      const std::uint32_t i = static_cast<std::uint32_t>(entry);
      reads.hits.push_back(
          {frame.index.resolve(hits[i]), &hits[i], &rays[i], -normalize(rays[i].dir), widths[i]});
    }
    cover_run(frame, material, run, reads, covers);
  });
}

}  // namespace msbvh
