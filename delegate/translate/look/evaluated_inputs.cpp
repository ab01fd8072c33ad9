#include "delegate/translate/look/materialx.h"
#include "delegate/translate/look/preview_surface.h"
#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {

std::span<const std::string_view> evaluated_inputs(std::string_view identifier) {
  static constexpr std::string_view kOfSurface[] = {
      "diffuseColor", "emissiveColor", "useSpecularWorkflow", "specularColor", "metallic",
      "roughness",    "clearcoat",     "clearcoatRoughness",  "opacity",       "opacityMode",
      "ior",          "normal",        "opacityThreshold",    "displacement",  "fallback"};
  static constexpr std::string_view kOfTexture[] = {
      "file", "sourceColorSpace", "st", "wrapS", "wrapT", "scale", "bias", "fallback"};
  static constexpr std::string_view kOfTransform[] = {"in", "rotation", "scale", "translation", "fallback"};
  static constexpr std::string_view kOfReader[] = {"varname", "fallback"};
  static constexpr std::string_view kOfOthers[] = {"fallback"};
  if (identifier == kPreviewSurface) return kOfSurface;
  if (identifier == kTexture) return kOfTexture;
  if (identifier == kTransform2d) return kOfTransform;
  if (identifier.starts_with(kPrimvarReader)) return kOfReader;
  if (identifier == "ND_UsdPreviewSurface_surfaceshader") return kOfSurface;
  const std::span<const std::string_view> of_materialx = materialx_inputs(identifier);
  return of_materialx.empty() ? std::span<const std::string_view>(kOfOthers) : of_materialx;
}

int surface_rank(std::string_view identifier) {
  if (identifier == kPreviewSurface) return 0;
  return is_materialx_surface(identifier) ? 1 : 2;
}

}  // namespace msbvh::translate
