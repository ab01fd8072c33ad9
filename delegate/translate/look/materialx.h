// MaterialX's surfaces as UsdPreviewSurface networks, where constants, images and primvars drive them
// plainly: standard_surface, open_pbr_surface and MaterialX's own UsdPreviewSurface nodes (MaterialX 1.39's
// libraries).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/shader_network.h"

namespace msbvh::translate {

bool is_materialx_surface(std::string_view identifier);

// As evaluated_inputs() (preview_surface.h). Empty: none of MaterialX's nodes that are mapped.
std::span<const std::string_view> materialx_inputs(std::string_view identifier);

// The network whose surface is one of them with a UsdPreviewSurface in its place; one line says what of it
// was approximated or left out.
ShaderNetwork as_preview_network(const ShaderNetwork& network, std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
