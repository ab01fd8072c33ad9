// What a network whose surface is a UsdPreviewSurface means (OpenUSD's "UsdPreviewSurface Specification"), as
// far as a diffuse surface shows it. Textures are not evaluated yet: their mean stands in for them.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/scene/material.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/shader_network.h"
#include "delegate/translate/look/texture_source.h"

namespace msbvh::translate {

// The inputs of a node of that identifier that are evaluated: a front-end need not read others.
std::span<const std::string_view> evaluated_inputs(std::string_view identifier);

// None where the surface is no UsdPreviewSurface: displayColor shows. Inputs that are wrong or not supported
// yet are reported to `diagnostics` and count as what the message says; nothing throws for bad data. Numbers
// may be anything, NaN included: Translator::add_material checks them.
std::optional<Material> preview_surface(const ShaderNetwork& network, const TextureSource& textures,
                                        std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
