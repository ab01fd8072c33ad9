#include "core/scene/opacity.h"

#include <algorithm>

namespace msbvh {

bool reads_display_opacity(const Scene& scene, const Mesh& mesh) {
  const Material* material = material_of(scene, mesh);
  return mesh.display_opacity.authored() && (!material || material->opacity_from_display_opacity);
}

float constant_opacity(const Scene& scene, const Mesh& mesh) {
  const Material* material = material_of(scene, mesh);
  return rendered_opacity(material, material ? material->opacity : 1.0f);
}

float rendered_opacity(const Material* material, float value) {
  if (material && material->opacity_threshold > 0.0f)
    return value < material->opacity_threshold ? 0.0f : 1.0f;
  return std::clamp(value, 0.0f, 1.0f);
}

float least_opacity(const Scene& scene, const Mesh& mesh) {
  if (!reads_display_opacity(scene, mesh)) return constant_opacity(scene, mesh);
  const std::vector<float>& values = mesh.display_opacity.values;
  return rendered_opacity(material_of(scene, mesh), *std::min_element(values.begin(), values.end()));
}

}  // namespace msbvh
