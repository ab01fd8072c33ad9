// How a material displaces what it is bound to, as its network says: UsdPreviewSurface's `displacement`, a
// distance along the normal in the object's own units. It is in force where the material's
// outputs:displacement is connected, as the specification has it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/scalar_texture.h"
#include "delegate/translate/look/shader_network.h"
#include "delegate/translate/look/texture_coordinates.h"
#include "delegate/translate/look/texture_source.h"

namespace msbvh::translate {

// Farther than any scene is wide; under any transform that makes sense, coordinates do not overflow.
inline constexpr double kMaxDistance = 0x1p40;

struct Displacement {
  Origin origin{};        // for messages: the input
  double constant = 0.0;  // where there is no texture, and no primvar, or a mesh has none of that name
  std::string primvar{};  // of numbers; empty: none
  std::shared_ptr<const ScalarTexture> texture{};  // null: none
  TextureCoordinates coordinates{};                // of the texture
  double scale = 1.0, bias = 0.0;                  // of what the texture says

  // The primvar that a mesh must bring along; empty: none.
  const std::string& needed_primvar() const { return texture ? coordinates.primvar : primvar; }
};

// None where nothing is displaced. What is wrong or not supported yet is reported and leaves the surface
// where it is, or counts as what the message says.
std::optional<Displacement> displacement_of(const ShaderNetwork& network, const TextureSource& textures,
                                            std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
