// What a material's inputs are at one place.
#pragma once

#include <optional>
#include <span>

#include "core/scene/material.h"
#include "core/shade/bsdf/bsdf.h"
#include "core/shade/scene_index.h"
#include "core/texture/texture_cache.h"
#include "core/trace/ray.h"

namespace msbvh {

struct SurfaceValues {
  Vec3f diffuse_color, emissive_color, specular_color;
  float metallic = 0.0f, roughness = 0.0f, clearcoat = 0.0f, clearcoat_roughness = 0.0f, ior = 1.0f;
  float opacity = 1.0f;
  Vec3f normal{0.0f, 0.0f, 1.0f};  // in tangent space, any length
  bool bent_normal = false;        // whether it is another one than the surface's

  // Its constants.
  explicit SurfaceValues(const Material& material)
      : diffuse_color(material.diffuse_color),
        emissive_color(material.emissive_color),
        specular_color(material.specular_color),
        metallic(material.metallic),
        roughness(material.roughness),
        clearcoat(material.clearcoat),
        clearcoat_roughness(material.clearcoat_roughness),
        ior(material.ior),
        opacity(material.opacity),
        normal(material.normal),
        bent_normal(material.normal != Vec3f{0.0f, 0.0f, 1.0f}) {}
};

// The value of a primvar where something was hit: the instance's, else the geometry's. None where neither has
// it.
std::optional<Vec3f> primvar_at(const HitSource& source, const Hit& hit, PrimvarName name, float time);

// A material's constants with what drives them. `texels`: one for each of the material's texture reads,
// before scale and bias. displayColor and displayOpacity are not looked at: `values` has them already.
void drive(const Material& material, const HitSource& source, const Hit& hit, float time,
           std::span<const TexelColor> texels, SurfaceValues& values);
// The opacity alone: the texels of the read that drives it, if one does, are all that is read.
float driven_opacity(const Material& material, const HitSource& source, const Hit& hit, float time,
                     std::span<const TexelColor> texels);

// What reflects there. Values are clamped to where they mean something.
SurfaceLook look_of(const Material& material, const SurfaceValues& values);

}  // namespace msbvh
