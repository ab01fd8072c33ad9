// Stage 4, continued: what materials say of the surfaces that were hit, beyond constants and display colours.
#pragma once

#include <span>

#include "core/integrate/frame.h"
#include "core/integrate/material_reads.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// How wide camera rays are, for the footprints of textures: before the first rays are traced.
void begin_cones(const Frame& frame, PathBatch& batch);
RayCone camera_cone(const Frame& frame, float time);
// Of a ray that is scattered with that density.
RayCone scattered_cone(const Frame& frame, const RayCone& cone, float distance, float pdf);

// `order`: the places in the queue of those that are on a surface, by their materials (in the upper half).
// Sets the surfaces' colours and normals, where textures or primvars drive them, and how they reflect, where
// something does otherwise than diffusely.
void choose_looks(const Frame& frame, PathBatch& batch, std::span<const std::uint64_t> order, bool specular);

// Of kNone: diffuse in displayColor.
const Material& material_or_standard(const Scene& scene, std::uint32_t index);
// The read of the texture that drives an input; none where none does.
std::optional<std::uint32_t> read_of(const Material& material, SurfaceInput input);
// Where the coordinates are along which a material's normals are bent; none where nothing bends them.
std::optional<TexturePlace> normal_place(const Material& material, const MaterialReads& reads, std::size_t i,
                                         const MaterialHit& hit);
// What a material makes of one hit: `surface` is changed as above. Returns how it reflects. `texels`: of the
// material's reads; `normal_place`: normal_place().
SurfaceLook apply_material(const Material& material, const HitSource& source, const Hit& hit, float time,
                           std::span<const TexelColor> texels,
                           const std::optional<TexturePlace>& normal_place, SurfaceHit& surface);

// Of a surface with such a look: what takes the place of its Bsdf, if something does. `cover`: how it was
// met; `within`: whether the path is inside of glass.
SpecialLobe special_lobe(const HitSource& source, const Hit& hit, const Ray& ray, const SurfaceLook& look,
                         const Material& material, const SurfaceHit& surface, const Cover& cover,
                         bool within);

// Runs of the same material in such an order: body(material, its entries).
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

}  // namespace msbvh
