// Stage 4, continued: what materials say of the surfaces that were hit, beyond constants and display colours.
#pragma once

#include <span>

#include "core/integrate/frame.h"
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

// What a material makes of one hit: `surface` is changed as above. Returns how it reflects. `texels` and
// `normal_place` are those of the material's reads, and of the one that drives the normal.
SurfaceLook apply_material(const Material& material, const HitSource& source, const Hit& hit, float time,
                           std::span<const TexelColor> texels,
                           const std::optional<TexturePlace>& normal_place, SurfaceHit& surface);

// Of hits that were found: how opaque what they hit is, in [0, 1]. `width`: of each ray's cone there.
void find_opacities(const Frame& frame, std::span<const Ray> rays, std::span<const Hit> hits,
                    std::span<const float> widths, MaterialReads& reads, std::vector<std::uint64_t>& order,
                    std::vector<float>& opacities);

}  // namespace msbvh
