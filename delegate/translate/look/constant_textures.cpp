#include "delegate/translate/look/constant_textures.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "core/texture/constant_image.h"
#include "delegate/translate/primvars.h"

namespace msbvh::translate {
namespace {

// Where the constant of an input is.
Vec3f* color_of(Material& material, SurfaceInput input) {
  switch (input) {
    case SurfaceInput::kDiffuseColor:
      return &material.diffuse_color;
    case SurfaceInput::kEmissiveColor:
      return &material.emissive_color;
    case SurfaceInput::kSpecularColor:
      return &material.specular_color;
    default:
      return nullptr;
  }
}

float* number_of(Material& material, SurfaceInput input) {
  switch (input) {
    case SurfaceInput::kMetallic:
      return &material.metallic;
    case SurfaceInput::kRoughness:
      return &material.roughness;
    case SurfaceInput::kClearcoat:
      return &material.clearcoat;
    case SurfaceInput::kClearcoatRoughness:
      return &material.clearcoat_roughness;
    case SurfaceInput::kOpacity:
      return &material.opacity;
    case SurfaceInput::kIor:
      return &material.ior;
    default:
      return nullptr;
  }
}

// As core/shade/material takes what is driven: shares from 0 to 1, an ior that is positive.
float within(SurfaceInput input, float value) {
  const bool any = input == SurfaceInput::kIor || input == SurfaceInput::kOpacity;
  return any ? value : std::clamp(value, 0.0f, 1.0f);
}

// False where the input has no constant that could stand for it.
bool fold(const DrivenInput& driven, const TextureRead& read, const TexelColor& texel, Material& material) {
  TexelColor value{};
  for (std::size_t i = 0; i < 4; ++i) value[i] = texel[i] * read.scale[i] + read.bias[i];
  if (Vec3f* color = color_of(material, driven.input)) {
    const auto at = [&](std::size_t i) { return value[driven.grey ? driven.channel : i]; };
    const Vec3f found{at(0), at(1), at(2)};
    if (!is_color(found)) return false;
    *color = {std::max(found.x, 0.0f), std::max(found.y, 0.0f), std::max(found.z, 0.0f)};
    return true;
  }
  float* number = number_of(material, driven.input);
  if (number == nullptr) return false;
  const float found = value[driven.channel];
  if (driven.input == SurfaceInput::kIor && !(found > 0.0f)) return false;
  *number = within(driven.input, found);
  return true;
}

// Keeps those that are still read, in their order; `index` of each user is renumbered.
template <typename Item, typename Users>
void keep_read(std::vector<Item>& items, const Users& for_each_index) {
  std::vector<bool> read(items.size(), false);
  for_each_index([&](std::uint32_t& index) { read[index] = true; });
  std::vector<std::uint32_t> place(items.size());
  std::vector<Item> kept;
  for (std::size_t i = 0; i < items.size(); ++i) {
    place[i] = std::uint32_t(kept.size());
    if (read[i]) kept.push_back(std::move(items[i]));
  }
  items = std::move(kept);
  for_each_index([&](std::uint32_t& index) { index = place[index]; });
}

void drop_unread(SurfaceLook& look) {
  Material& material = look.material;
  keep_read(material.texture_reads, [&](const auto& use) {
    for (DrivenInput& input : material.driven)
      if (input.source == DrivenInput::Source::kTexture) use(input.index);
  });
  keep_read(look.textures, [&](const auto& use) {
    for (TextureRead& read : material.texture_reads) use(read.texture);
  });
  keep_read(look.primvars, [&](const auto& use) {
    if (material.normal_coordinates != kNoPrimvar) use(material.normal_coordinates);
    for (TextureRead& read : material.texture_reads)
      if (read.coordinates != kNoPrimvar) use(read.coordinates);
    for (DrivenInput& input : material.driven)
      if (input.source == DrivenInput::Source::kPrimvar) use(input.index);
  });
}

}  // namespace

void fold_constant_textures(SurfaceLook& look, const std::string& rendering_space) {
  Material& material = look.material;
  std::vector<std::optional<TexelColor>> colors;
  for (const ImageTexture& texture : look.textures)
    colors.push_back(constant_color(texture, rendering_space));
  if (std::ranges::none_of(colors, [](const auto& color) { return color.has_value(); })) return;
  std::erase_if(material.driven, [&](const DrivenInput& driven) {
    if (driven.source != DrivenInput::Source::kTexture) return false;
    const TextureRead& read = material.texture_reads[driven.index];
    return colors[read.texture] && fold(driven, read, *colors[read.texture], material);
  });
  drop_unread(look);
  material.specular = reflects(material);
}

bool reflects(const Material& material) {
  const bool by_constant = !material.opacity_from_display_opacity &&
                           std::ranges::find(material.driven, SurfaceInput::kOpacity, &DrivenInput::input) ==
                               material.driven.end();
  const bool nowhere = by_constant && !material.transparent_reflects &&
                       (material.opacity <= 0.0f || material.opacity < material.opacity_threshold);
  return !nowhere;
}

}  // namespace msbvh::translate
