// A material as its network alone says, before it is one of a scene's.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/material.h"
#include "core/texture/image_texture.h"

namespace msbvh::translate {

// A primvar that a material reads.
struct NeededPrimvar {
  std::string name;         // without primvars:
  std::uint32_t width = 1;  // how many numbers make up a value, at least: 1 to 4, of which three count
  bool operator==(const NeededPrimvar&) const = default;
};

struct SurfaceLook {
  SurfaceLook(Material material_ = {}) : material(std::move(material_)) {}

  // Its TextureIds and PrimvarNames are places in the lists below.
  Material material;
  std::vector<ImageTexture> textures{};
  std::vector<NeededPrimvar> primvars{};
};

}  // namespace msbvh::translate
