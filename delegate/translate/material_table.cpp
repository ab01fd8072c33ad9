#include "delegate/translate/material_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/error.h"
#include "delegate/translate/primvars.h"

namespace msbvh::translate {
namespace {

bool is_sound(const Material& material) {
  const float numbers[] = {
      material.opacity, material.opacity_threshold, material.metallic,           material.roughness,
      material.ior,     material.clearcoat,         material.clearcoat_roughness};
  return is_color(material.diffuse_color) && is_finite(material.emissive_color) &&
         is_color(material.specular_color) && is_color(material.normal) &&
         std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); });
}

void check_place(std::size_t place, std::size_t size, const std::string& part, const char* what) {
  if (place < size) return;
  throw Error(message(part, ": found ", what, " ", place, "; expected less than ", size));
}

// Under any name.
bool reads_alike(const ImageTexture& a, ImageTexture b) {
  b.name = a.name;
  return a == b;
}

}  // namespace

std::uint32_t MaterialTable::add(SurfaceLook look, Scene& scene, PrimLog& log) {
  Material material = std::move(look.material);
  if (!is_sound(material)) {
    log.warn("inputs",
             "a colour, an opacity or another number is not finite or too large; expected finite numbers, of "
             "colours but emissiveColor at most 65504; the default material is taken");
    Material standard;
    standard.name = material.name;
    material = std::move(standard);
  }
  std::vector<PrimvarName> reads;
  const auto name_of = [&](PrimvarName place) {
    check_place(place, look.primvars.size(), material.name, "primvar");
    reads.push_back(primvar(look.primvars[place].name, scene));
    return reads.back();
  };
  for (TextureRead& read : material.texture_reads) {
    check_place(read.texture, look.textures.size(), material.name, "texture");
    read.texture = texture(look.textures[read.texture], scene);
    if (read.coordinates != kNoPrimvar) read.coordinates = name_of(read.coordinates);
  }
  for (DrivenInput& input : material.driven) {
    if (input.source == DrivenInput::Source::kPrimvar) input.index = name_of(input.index);
  }
  if (material.normal_coordinates != kNoPrimvar)
    material.normal_coordinates = name_of(material.normal_coordinates);
  std::ranges::sort(reads);
  reads.erase(std::unique(reads.begin(), reads.end()), reads.end());
  reads_.push_back(std::move(reads));
  scene.materials.push_back(std::move(material));
  return std::uint32_t(scene.materials.size() - 1);
}

TextureId MaterialTable::texture(ImageTexture image, Scene& scene) {
  const std::string file = image.tiles.empty() ? std::string() : image.tiles.front().file.path;
  std::vector<TextureId>& of_file = textures_[file];
  for (const TextureId known : of_file) {
    if (reads_alike(scene.textures[known], image)) return known;
  }
  scene.textures.push_back(std::move(image));
  of_file.push_back(TextureId(scene.textures.size() - 1));
  return of_file.back();
}

PrimvarName MaterialTable::primvar(const std::string& name, Scene& scene) {
  const auto [found, is_new] = primvars_.try_emplace(name, PrimvarName(scene.primvar_names.size()));
  if (is_new) scene.primvar_names.push_back(name);
  return found->second;
}

void MaterialTable::keep(const std::string& name, Scene& scene) { kept_.push_back(primvar(name, scene)); }

std::span<const PrimvarName> MaterialTable::reads(std::uint32_t material) const {
  return material < reads_.size() ? std::span<const PrimvarName>(reads_[material])
                                  : std::span<const PrimvarName>();
}

PrimvarName MaterialTable::find(const std::string& primvar) const {
  const auto found = primvars_.find(primvar);
  return found == primvars_.end() ? kNoPrimvar : found->second;
}

}  // namespace msbvh::translate
