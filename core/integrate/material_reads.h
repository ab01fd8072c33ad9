// Reads the textures of one material for many hits at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/scene/material.h"
#include "core/shade/material/texture_place.h"
#include "core/texture/texture_cache.h"

namespace msbvh {

// A hit on a surface of the material.
struct MaterialHit {
  HitSource source;
  const Hit* hit;
  const Ray* ray;
  Vec3f geometric_normal;
  float width;  // of the ray's cone there
};

// Room for what is read, kept from material to material.
class MaterialReads {
 public:
  // `only`: one of the material's reads; none: all of them.
  void read(const TextureCache& textures, const Material& material, std::span<const MaterialHit> hits,
            std::optional<std::uint32_t> only = {});

  // What read() found, a texel each of the material's reads.
  std::span<const TexelColor> texels(std::size_t hit) const { return {&texels_[hit * reads_], reads_}; }
  // Where the coordinates of that read are.
  const std::optional<TexturePlace>& place(std::size_t hit, std::uint32_t read) const {
    return places_[place_of_read_[read]][hit];
  }

  std::vector<MaterialHit> hits;  // for whoever gathers them

 private:
  void read_one(const TextureCache& textures, const Material& material, std::span<const MaterialHit> hits,
                std::uint32_t which);
  std::size_t places_of(PrimvarName name, std::span<const MaterialHit> hits);

  std::size_t reads_ = 0;
  std::vector<TexelColor> texels_;          // [hit][read]
  std::vector<std::size_t> place_of_read_;  // in places_
  std::vector<PrimvarName> place_names_;    // of those of places_ that count
  std::vector<std::vector<std::optional<TexturePlace>>> places_;
  std::vector<TextureQuery> queries_;
  std::vector<TexelColor> found_;
};

}  // namespace msbvh
