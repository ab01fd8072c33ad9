#include "delegate/translate/look/texture_coordinates.h"

#include <cmath>
#include <numbers>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

// UsdTransform2d nodes one behind the other. A circle of them has no end.
constexpr int kMostTransforms = 64;

// `inner` is applied first.
void prepend(const std::array<double, 4>& m, const std::array<double, 2>& offset, TextureCoordinates& outer) {
  const std::array<double, 4> o = outer.matrix;
  outer.offset = outer.mapped(offset[0], offset[1]);
  outer.matrix = {o[0] * m[0] + o[1] * m[2], o[0] * m[1] + o[1] * m[3], o[2] * m[0] + o[3] * m[2],
                  o[2] * m[1] + o[3] * m[3]};
}

const ShaderNode* source_of(const ShaderNode& node, std::string_view name, const ShaderNetwork& network) {
  const ShaderInput* input = node.input(name);
  return input && !input->connections.empty() ? network.node(input->connections.front().node) : nullptr;
}

// A node that has texture coordinates, after all transforms; adds these.
const ShaderNode* behind_transforms(const ShaderNode* node, const ShaderNetwork& network, const PrimLog& log,
                                    TextureCoordinates& coordinates) {
  for (int i = 0; node && node->identifier == kTransform2d && i < kMostTransforms; ++i) {
    const double radians = checked_number(0.0, *node, "rotation", log) * (std::numbers::pi / 180.0);
    const double cosine = std::cos(radians), sine = std::sin(radians);
    const auto scale = checked_numbers<2>({1.0, 1.0}, *node, "scale", log);
    const auto translation = checked_numbers<2>({}, *node, "translation", log);
    prepend({cosine * scale[0], -sine * scale[1], sine * scale[0], cosine * scale[1]}, translation,
            coordinates);
    coordinates.fallback = checked_numbers<2>({}, *node, "in", log);
    node = source_of(*node, "in", network);
  }
  return node;
}

// Whether single precision holds the map.
bool is_usable(const TextureCoordinates& coordinates) {
  constexpr double kLargest = 0x1p60;
  const auto fits = [](double value) { return std::abs(value) <= kLargest; };
  return std::ranges::all_of(coordinates.matrix, fits) && std::ranges::all_of(coordinates.offset, fits) &&
         std::ranges::all_of(coordinates.fallback, fits);
}

}  // namespace

TextureCoordinates coordinates_of(const ShaderNode& texture, const ShaderNetwork& network,
                                  const PrimLog& log) {
  TextureCoordinates coordinates;
  PrimLog own = log.of_prim(texture.path);
  coordinates.fallback = checked_numbers<2>({}, texture, "st", log);
  const ShaderNode* node = behind_transforms(source_of(texture, "st", network), network, log, coordinates);
  if (!is_usable(coordinates)) {
    own.warn("inputs:st",
             "UsdTransform2d maps it beyond 2^60, expected smaller numbers; the texture is read at (0, 0) "
             "throughout");
    return {};
  }
  if (!node) return coordinates;
  if (node->identifier == std::string(kPrimvarReader) + "_float2") {
    coordinates.primvar = text_of(*node, "varname");
    coordinates.fallback = checked_numbers<2>({}, *node, "fallback", log);
    if (coordinates.primvar.empty()) {
      log.of_prim(node->path)
          .warn("inputs:varname", "found no name of a primvar; the texture is read at the reader's fallback");
    }
    return coordinates;
  }
  if (node->identifier == kTransform2d) {
    own.warn("inputs:st", "connected to a UsdTransform2d in a circle of them, or to more than " +
                              std::to_string(kMostTransforms) + "; the texture is read at (0, 0) throughout");
    return {};
  }
  const std::string what = node->identifier.empty() ? "node of no known type" : node->identifier;
  own.warn("inputs:st", "connected to a " + what +
                            ", which is not evaluated yet; the texture is read at (0, 0) throughout");
  coordinates.fallback = {};
  return coordinates;
}

}  // namespace msbvh::translate
