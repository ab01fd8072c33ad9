// What a surface is made of.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/texture/image_texture.h"

namespace msbvh {

// Inputs of a surface that may vary over it.
enum class SurfaceInput : std::uint8_t {
  kDiffuseColor,
  kEmissiveColor,
  kSpecularColor,
  kMetallic,
  kRoughness,
  kClearcoat,
  kClearcoatRoughness,
  kOpacity,
  kIor,
  kNormal  // in tangent space
};

// Of three numbers; the others are of one.
constexpr bool is_color(SurfaceInput input) {
  return input == SurfaceInput::kDiffuseColor || input == SurfaceInput::kEmissiveColor ||
         input == SurfaceInput::kSpecularColor || input == SurfaceInput::kNormal;
}

// A primvar of that name on what is hit: in Scene::primvar_names.
using PrimvarName = std::uint32_t;
inline constexpr PrimvarName kNoPrimvar = std::numeric_limits<PrimvarName>::max();

// How a material reads one of the scene's textures: value * scale + bias at
// (s, t) = matrix * coordinates + offset.
struct TextureRead {
  TextureId texture = 0;
  PrimvarName coordinates = kNoPrimvar;                 // of two numbers
  std::array<float, 2> fallback_coordinates{};          // where there is no such primvar
  std::array<float, 4> matrix{1.0f, 0.0f, 0.0f, 1.0f};  // row by row
  std::array<float, 2> offset{};
  std::array<float, 4> scale{1.0f, 1.0f, 1.0f, 1.0f}, bias{};
  bool operator==(const TextureRead&) const = default;
};

// An input that takes its value from elsewhere than its constant.
struct DrivenInput {
  enum class Source : std::uint8_t { kPrimvar, kTexture };

  SurfaceInput input = SurfaceInput::kDiffuseColor;
  Source source = Source::kTexture;
  std::uint32_t index = 0;   // in Material::texture_reads; or a PrimvarName
  std::uint8_t channel = 0;  // the first that is read: one for a number, three from here on for a colour
  bool grey = false;         // of a colour: that channel alone, three times
  bool operator==(const DrivenInput&) const = default;
};

// A UsdPreviewSurface (OpenUSD's "UsdPreviewSurface Specification"). Colours are linear, in the rendering
// space.
struct Material {
  std::string name{};
  Vec3f diffuse_color{0.18f, 0.18f, 0.18f};
  bool diffuse_from_display_color = false;  // diffuseColor is connected to a reader of primvars:displayColor
  Vec3f emissive_color{};
  bool emissive_from_display_color = false;  // likewise of emissiveColor
  float opacity = 1.0f;
  bool opacity_from_display_opacity = false;
  float opacity_threshold = 0.0f;  // > 0: opacity below it counts as 0, else as 1 (UsdPreviewSurface)

  // Whether it reflects as a mirror does, however roughly, besides diffusely. What follows counts only then.
  bool specular = false;
  bool specular_workflow = false;  // specular_color in place of metallic
  Vec3f specular_color{};          // reflectance at normal incidence
  float metallic = 0.0f;
  float roughness = 0.5f;  // alpha = roughness^2
  float ior = 1.5f;
  float clearcoat = 0.0f;
  float clearcoat_roughness = 0.01f;
  // opacityMode: what is transparent still reflects as glass does; a presence takes all of it away.
  bool transparent_reflects = false;
  Vec3f normal{0.0f, 0.0f, 1.0f};  // in tangent space; need not be unit length
  // Of a normal that no texture drives: the coordinates along which its x and y are.
  PrimvarName normal_coordinates = kNoPrimvar;

  std::vector<TextureRead> texture_reads{};
  // Each input at most once; a constant above stands where its primvar is missing on what is hit.
  std::vector<DrivenInput> driven{};
};

}  // namespace msbvh
