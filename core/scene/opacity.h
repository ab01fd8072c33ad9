// How opaque a surface is: the one rule that the effect plan and the shading share.
#pragma once

#include "core/scene/scene.h"

namespace msbvh {

// Null for kNone: diffuse in displayColor.
inline const Material* material_at(const Scene& scene, std::uint32_t index) {
  return index == kNone ? nullptr : &scene.materials[index];
}

// Of a triangle, as long as no instance overrides it; kNone for none.
inline std::uint32_t material_index(const Mesh& mesh, std::uint32_t triangle) {
  return mesh.triangle_materials.empty() ? mesh.material : mesh.triangle_materials[triangle];
}

inline std::uint32_t material_index(const Grids& grids, std::uint32_t triangle) {
  return grids.grid_materials.empty() ? grids.material
                                      : grids.grid_materials[grids.shape.triangle(triangle).grid];
}

// Whether something else than displayOpacity drives it, which only shading can say.
bool drives_opacity(const Material* material);
// Whether displayOpacity decides under a material, which may be null. Otherwise the opacity is the same
// everywhere: constant_opacity().
bool reads_display_opacity(const Appearance& look, const Material* material);
float constant_opacity(const Material* material);

// From a value read there to the opacity in [0, 1] that is rendered. `material` may be null. A material's
// opacityThreshold cuts out, as UsdPreviewSurface says.
float rendered_opacity(const Material* material, float value);

// The least rendered opacity, or what it may be (0) where textures or primvars drive it, on a geometry under
// a material, which may be null, over all its values and keys.
float least_opacity(const Appearance& look, const Material* material);
// Under its own material, or materials.
float least_opacity(const Scene& scene, const Appearance& look);
float least_opacity(const Scene& scene, const Mesh& mesh);
float least_opacity(const Scene& scene, const Grids& grids);
// Of whatever kind.
float least_opacity(const Scene& scene, GeometryId geometry);

}  // namespace msbvh
