#include "core/shade/material/surface_values.h"

#include <algorithm>

#include "core/shade/bsdf/microfacet.h"
#include "core/shade/value_at.h"

namespace msbvh {
namespace {

float unit(float value) { return std::clamp(value, 0.0f, 1.0f); }
Vec3f unit(const Vec3f& c) { return {unit(c.x), unit(c.y), unit(c.z)}; }
Vec3f not_negative(const Vec3f& c) { return {std::max(0.0f, c.x), std::max(0.0f, c.y), std::max(0.0f, c.z)}; }

// What an input takes from four channels.
struct Channels {
  std::array<float, 4> values;

  float number(const DrivenInput& input) const { return values[input.channel]; }
  Vec3f color(const DrivenInput& input) const {
    if (input.grey) return {number(input), number(input), number(input)};
    return {values[input.channel], values[input.channel + 1u], values[input.channel + 2u]};
  }
};

Channels scaled(const TextureRead& read, const TexelColor& texel) {
  Channels channels{};
  for (std::size_t i = 0; i < 4; ++i) channels.values[i] = texel[i] * read.scale[i] + read.bias[i];
  return channels;
}

void set(const DrivenInput& input, const Channels& from, SurfaceValues& values) {
  switch (input.input) {
    case SurfaceInput::kDiffuseColor:
      values.diffuse_color = from.color(input);
      return;
    case SurfaceInput::kEmissiveColor:
      values.emissive_color = not_negative(from.color(input));
      return;
    case SurfaceInput::kSpecularColor:
      values.specular_color = from.color(input);
      return;
    case SurfaceInput::kMetallic:
      values.metallic = from.number(input);
      return;
    case SurfaceInput::kRoughness:
      values.roughness = from.number(input);
      return;
    case SurfaceInput::kClearcoat:
      values.clearcoat = from.number(input);
      return;
    case SurfaceInput::kClearcoatRoughness:
      values.clearcoat_roughness = from.number(input);
      return;
    case SurfaceInput::kOpacity:
      values.opacity = from.number(input);
      return;
    case SurfaceInput::kIor:
      values.ior = from.number(input);
      return;
    case SurfaceInput::kNormal:
      values.normal = from.color(input);
      values.bent_normal = true;
      return;
  }
}

// Beyond it, and below its inverse, everything is reflected but for rounding; what drives it may be negative.
constexpr float kMostIor = 1000.0f;

// Of light that meets the boundary to air head-on.
float reflectance_of(float ior) {
  const float ratio = (1.0f - ior) / (1.0f + ior);
  return ratio * ratio;
}

}  // namespace

std::optional<Vec3f> primvar_at(const HitSource& source, const Hit& hit, PrimvarName name, float time) {
  if (source.instances) {
    for (const InstancePrimvar& primvar : source.instances->primvars) {
      if (primvar.name == name) return primvar.values[source.instance];
    }
  }
  for (const SurfacePrimvar& primvar : source.look->primvars) {
    if (primvar.name == name && primvar.primvar.authored())
      return value_at(primvar.primvar, source, hit, time);
  }
  return std::nullopt;
}

namespace {

void drive_one(const Material& material, const DrivenInput& input, const HitSource& source, const Hit& hit,
               float time, std::span<const TexelColor> texels, SurfaceValues& values) {
  if (input.source == DrivenInput::Source::kTexture) {
    set(input, scaled(material.texture_reads[input.index], texels[input.index]), values);
  } else if (const std::optional<Vec3f> found = primvar_at(source, hit, input.index, time)) {
    set(input, {{found->x, found->y, found->z, 0.0f}}, values);
  }
}

}  // namespace

void drive(const Material& material, const HitSource& source, const Hit& hit, float time,
           std::span<const TexelColor> texels, SurfaceValues& values) {
  for (const DrivenInput& input : material.driven)
    drive_one(material, input, source, hit, time, texels, values);
}

float driven_opacity(const Material& material, const HitSource& source, const Hit& hit, float time,
                     std::span<const TexelColor> texels) {
  SurfaceValues values(material);
  for (const DrivenInput& input : material.driven) {
    if (input.input == SurfaceInput::kOpacity) drive_one(material, input, source, hit, time, texels, values);
  }
  return values.opacity;
}

SurfaceLook look_of(const Material& material, const SurfaceValues& values) {
  const Vec3f base = not_negative(values.diffuse_color);
  SurfaceLook look;
  look.diffuse = base;
  if (!material.specular) return look;
  look.ior = std::min(kMostIor, std::max(1.0f / kMostIor, values.ior));
  look.alpha = alpha_of(unit(values.roughness));
  look.coat = unit(values.clearcoat);
  look.coat_f0 = reflectance_of(look.ior);
  look.coat_alpha = alpha_of(unit(values.clearcoat_roughness));
  if (material.specular_workflow) {
    look.f0 = unit(values.specular_color);
    look.f90 = {1.0f, 1.0f, 1.0f};
    return look;
  }
  const float metallic = unit(values.metallic);
  const Vec3f white{1.0f, 1.0f, 1.0f}, tint = white + (unit(base) - white) * metallic;
  look.metal = metallic;
  look.f90 = tint;
  look.f0 = tint * (reflectance_of(look.ior) * (1.0f - metallic) + metallic);
  look.diffuse = base * (1.0f - metallic);
  return look;
}

}  // namespace msbvh
