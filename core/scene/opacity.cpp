#include "core/scene/opacity.h"

#include <algorithm>
#include <vector>

namespace msbvh {

bool drives_opacity(const Material* material) {
  return material && std::ranges::any_of(material->driven, [](const DrivenInput& driven) {
           return driven.input == SurfaceInput::kOpacity;
         });
}

bool reads_display_opacity(const Appearance& look, const Material* material) {
  return look.display_opacity.authored() && (!material || material->opacity_from_display_opacity);
}

float constant_opacity(const Material* material) {
  return rendered_opacity(material, material ? material->opacity : 1.0f);
}

float rendered_opacity(const Material* material, float value) {
  if (material && material->opacity_threshold > 0.0f)
    return value < material->opacity_threshold ? 0.0f : 1.0f;
  return std::clamp(value, 0.0f, 1.0f);
}

float least_opacity(const Appearance& look, const Material* material) {
  if (drives_opacity(material)) return 0.0f;
  if (!reads_display_opacity(look, material)) return constant_opacity(material);
  const std::vector<float>& values = look.display_opacity.values;
  return rendered_opacity(material, *std::min_element(values.begin(), values.end()));
}

float least_opacity(const Scene& scene, const Appearance& look) {
  return least_opacity(look, material_at(scene, look.material));
}

float least_opacity(const Scene& scene, GeometryId geometry) {
  if (geometry.is(GeometryKind::kTriangleMesh)) return least_opacity(scene, scene.mesh(geometry));
  if (geometry.is(GeometryKind::kGridMesh)) return least_opacity(scene, scene.grids[geometry.index()]);
  return least_opacity(scene, *scene.appearance(geometry));
}

namespace {

// Under any of some materials.
float least_opacity(const Scene& scene, const Appearance& look, const std::vector<std::uint32_t>& materials) {
  if (materials.empty()) return least_opacity(look, material_at(scene, look.material));
  std::vector<bool> seen(scene.materials.size() + 1, false);  // the last stands for kNone
  float least = 1.0f;
  for (const std::uint32_t material : materials) {
    const std::size_t index = std::min<std::size_t>(material, scene.materials.size());
    if (seen[index]) continue;
    seen[index] = true;
    least = std::min(least, least_opacity(look, material_at(scene, material)));
  }
  return least;
}

}  // namespace

float least_opacity(const Scene& scene, const Mesh& mesh) {
  return least_opacity(scene, mesh, mesh.triangle_materials);
}

float least_opacity(const Scene& scene, const Grids& grids) {
  return least_opacity(scene, grids, grids.grid_materials);
}

}  // namespace msbvh
