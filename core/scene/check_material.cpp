#include "core/scene/check_material.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/scene/gate.h"

namespace msbvh {

namespace {

using namespace gate;

// What a material reads from elsewhere.
void check_reads(const Material& material, const Scene& scene, const std::string& part) {
  for (const TextureRead& read : material.texture_reads) {
    expect_index(read.texture, scene.textures.size(), part, "texture");
    if (read.coordinates != kNoPrimvar)
      expect_index(read.coordinates, scene.primvar_names.size(), part, "coordinates");
    const auto finite = [](const auto& values) {
      return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
    };
    expect(finite(read.fallback_coordinates) && finite(read.matrix) && finite(read.offset) &&
               finite(read.scale) && finite(read.bias),
           part, "textureReads", "NaN or infinity", "finite numbers");
  }
  if (material.normal_coordinates != kNoPrimvar)
    expect_index(material.normal_coordinates, scene.primvar_names.size(), part, "normalCoordinates");
  std::vector<SurfaceInput> driven;
  for (const DrivenInput& each : material.driven) {
    if (each.source == DrivenInput::Source::kTexture) {
      expect_index(each.index, material.texture_reads.size(), part, "driven");
    } else {
      expect_index(each.index, scene.primvar_names.size(), part, "driven");
    }
    const unsigned channels = each.source == DrivenInput::Source::kTexture ? 4u : 3u;
    const unsigned read = is_color(each.input) && !each.grey ? 3u : 1u;
    expect(each.channel + read <= channels, part, "channel",
           std::to_string(each.channel) + " and " + std::to_string(read - 1) + " after it",
           "less than " + std::to_string(channels));
    driven.push_back(each.input);
  }
  std::sort(driven.begin(), driven.end());
  expect(std::adjacent_find(driven.begin(), driven.end()) == driven.end(), part, "driven", "an input twice",
         "each at most once");
}

void expect_share(float value, const std::string& part, const std::string& attribute) {
  expect(value >= 0.0f && value <= 1.0f, part, attribute, std::to_string(value), "a number from 0 to 1");
}

}  // namespace

void check_material(const Material& material, const Scene& scene, const std::string& part) {
  check_reads(material, scene, part);
  expect(is_finite(material.specular_color), part, "specularColor", "NaN or infinity", "a finite colour");
  expect(is_finite(material.normal), part, "normal", "NaN or infinity", "a finite vector");
  expect_share(material.metallic, part, "metallic");
  expect_share(material.roughness, part, "roughness");
  expect_share(material.clearcoat, part, "clearcoat");
  expect_share(material.clearcoat_roughness, part, "clearcoatRoughness");
  expect(std::isfinite(material.ior) && material.ior > 0.0f, part, "ior", std::to_string(material.ior),
         "a finite number above 0");
  expect(is_finite(material.diffuse_color), part, "diffuseColor", "NaN or infinity", "a finite colour");
  expect(is_finite(material.emissive_color), part, "emissiveColor", "NaN or infinity", "a finite colour");
  expect(std::isfinite(material.opacity), part, "opacity", "NaN or infinity", "a finite number");
  expect(std::isfinite(material.opacity_threshold), part, "opacityThreshold", "NaN or infinity",
         "a finite number");
}

void check_texture(const ImageTexture& texture, const std::string& part) {
  expect(texture.udim ? !texture.tiles.empty() : texture.tiles.size() == 1, part, "tiles",
         std::to_string(texture.tiles.size()), texture.udim ? "at least one" : "one");
  for (const TextureTile& tile : texture.tiles)
    expect(!tile.file.path.empty(), part, "file", "no path", "one");
  const auto& fallback = texture.fallback;
  expect(std::all_of(fallback.begin(), fallback.end(), [](float x) { return std::isfinite(x); }), part,
         "fallback", "NaN or infinity", "finite numbers");
}

void check_primvar_names(const Scene& scene) {
  std::vector<std::string> names = scene.primvar_names;
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  expect(twice == names.end(), "scene", "primvarNames",
         twice == names.end() ? "" : "\"" + *twice + "\" twice", "each once");
}

}  // namespace msbvh
