// What a UsdUVTexture node means (OpenUSD's "UsdPreviewSurface Specification"): an image, and how it is read.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/texture/image_texture.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/shader_network.h"
#include "delegate/translate/look/texture_coordinates.h"
#include "delegate/translate/look/texture_source.h"

namespace msbvh::translate {

// OpenColorIO's name of sRGB's primaries under sRGB's curve, and what stands for the rule of
// sourceColorSpace's auto.
inline constexpr const char* kSrgb = "srgb_rec709_scene";
inline constexpr const char* kAutoColorSpace = "auto";

// A texture that there is a file of.
struct SurfaceTexture {
  ImageTexture image;
  TextureCoordinates coordinates;
  Rgba scale{}, bias{};
};

// The channel that one of a texture's outputs is; none: all channels.
std::optional<std::size_t> channel_of(std::string_view output);

// Why there is none.
struct NoFile {
  std::string why;
};

// The image is not opened. What is wrong is reported to `log`, which is of the surface, and counts as the
// node's default. `image.fallback` is such that scale and bias make the node's `fallback` of it, which they
// leave alone; of one that is not authored, `standard` stands.
std::optional<SurfaceTexture> surface_texture(const ShaderNode& node, const ShaderNetwork& network,
                                              const TextureSource& textures, const Rgba& standard,
                                              PrimLog log, NoFile& no_file);

}  // namespace msbvh::translate
