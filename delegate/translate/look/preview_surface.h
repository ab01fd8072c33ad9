// What a network whose surface is a UsdPreviewSurface means (OpenUSD's "UsdPreviewSurface Specification"):
// constants, and inputs that textures and primvars drive. No image is opened here.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/shader_network.h"
#include "delegate/translate/look/surface_look.h"
#include "delegate/translate/look/texture_source.h"

namespace msbvh::translate {

// The inputs of a node of that identifier that are evaluated: a front-end need not read others.
std::span<const std::string_view> evaluated_inputs(std::string_view identifier);

// Among the surfaces of a material's render contexts: 0 what is read as it is, 1 what is mapped to it
// (materialx.h), 2 what is not drawn.
int surface_rank(std::string_view identifier);

// None where the surface is none that is drawn: displayColor shows. Inputs that are wrong or not supported
// are reported to `diagnostics` and count as what the message says; nothing throws for bad data. Numbers
// outside of the range that the specification gives are taken to its ends; they may be NaN:
// Translator::add_material checks them.
std::optional<SurfaceLook> preview_surface(const ShaderNetwork& network, const TextureSource& textures,
                                           std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
