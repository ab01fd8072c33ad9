// How opaque a surface is: the one rule that the effect plan and the shading share.
#pragma once

#include "core/scene/scene.h"

namespace msbvh {

inline const Material* material_of(const Scene& scene, const Mesh& mesh) {
  return mesh.material == kNone ? nullptr : &scene.materials[mesh.material];
}

// Whether the mesh's displayOpacity decides. Otherwise its opacity is the same everywhere:
// constant_opacity().
bool reads_display_opacity(const Scene& scene, const Mesh& mesh);
float constant_opacity(const Scene& scene, const Mesh& mesh);

// From a value read there to the opacity in [0, 1] that is rendered. `material` may be null. A material's
// opacityThreshold cuts out, as UsdPreviewSurface says.
float rendered_opacity(const Material* material, float value);

// The least rendered opacity on the mesh, over all its values and keys.
float least_opacity(const Scene& scene, const Mesh& mesh);

}  // namespace msbvh
