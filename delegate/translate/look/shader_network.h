// A material's shading network as a front-end has read it: nodes, what their inputs hold, and what is
// connected to what, as Hydra's HdMaterialNetwork2 has them. What nodes mean is decided elsewhere
// (preview_surface.h).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace msbvh::translate {

// A file that an input names.
struct Asset {
  std::string path;                  // as authored
  std::vector<std::string> files{};  // resolved: one, a UDIM texture's tiles in order, or none
  // What the stage says that the file holds, for all who read it (an attribute's colorSpace, ColorSpaceAPI);
  // empty: nothing.
  std::string color_space{};
};

// A vector has two to four numbers of any precision; tokens are strings. std::monostate: of another type,
// such as a matrix.
using ShaderData = std::variant<std::monostate, bool, double, std::vector<double>, std::string, Asset>;

struct ShaderValue {
  ShaderData data{};
  // For messages: the value and its type, as the front-end prints them.
  std::string text{}, type{};
};

// To what another node computes.
struct ShaderConnection {
  std::string node;    // its path
  std::string output;  // its name
};

// Where something was authored, for messages.
struct Origin {
  std::string path, attribute;
};

struct ShaderInput {
  std::string name;
  std::optional<ShaderValue> value{};  // at the frame; none: the node's default
  // The different values over the open shutter, where they are not the frame's alone.
  std::vector<std::optional<ShaderValue>> in_shutter{};
  // The first one counts, and more than a value does.
  std::vector<ShaderConnection> connections{};
  // Of the value, which may come from the material's interface; none: the node's own input.
  std::optional<Origin> origin{};
};

struct ShaderNode {
  std::string path;
  std::string identifier;  // such as UsdPreviewSurface; empty: the front-end knows none
  std::vector<ShaderInput> inputs{};

  // Null where there is none of that name.
  const ShaderInput* input(std::string_view name) const;
};

struct ShaderNetwork {
  std::string path;                                     // of the material
  std::vector<ShaderNode> nodes{};                      // each once, in any order; cycles are allowed
  std::map<std::string, ShaderConnection> terminals{};  // by name: surface

  // Null where there is none at that path.
  const ShaderNode* node(std::string_view node_path) const;
};

}  // namespace msbvh::translate
