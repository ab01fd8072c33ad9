// The nodes behind a MaterialX surface as those that drive a UsdPreviewSurface (materialx.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "delegate/translate/look/shader_network.h"

namespace msbvh::translate {

// What drives an input: a constant's numbers, or a node of the mapped network.
struct Drive {
  std::vector<double> numbers{};
  std::optional<ShaderConnection> from{};
};

// What an input is for.
struct Use {
  double factor = 1.0;  // by which it is multiplied
  int width = 1;        // how many numbers it has: 1 or 3
  bool normal = false;  // they are a normal's
};

class MaterialxNodes {
 public:
  // Borrows all three. Nodes are added to `to`, what is taken for something else is named in `lost`.
  MaterialxNodes(const ShaderNetwork& from, ShaderNetwork& to, std::vector<std::string>& lost)
      : from_(from), to_(to), lost_(lost) {}

  // None for what is not evaluated.
  std::optional<Drive> drive_of(const ShaderInput& input, const Use& use, int depth = 0);

 private:
  std::optional<Drive> through(const ShaderNode& node, const std::string& output, const Use& use, int depth);
  std::optional<Drive> channel(const ShaderNode& node, const std::string& output, std::optional<Drive> found);
  Drive image(const ShaderNode& node, const Use& use);
  Drive reader(const ShaderNode& node, int width);
  ShaderInput coordinates(const ShaderNode& image);
  std::string primvar_of(const ShaderNode* source);
  const ShaderNode* source_of(const ShaderNode& node, std::string_view name) const;
  std::string add(ShaderNode node, std::string_view suffix);

  const ShaderNetwork& from_;
  ShaderNetwork& to_;
  std::vector<std::string>& lost_;
};

ShaderInput constant(std::string name, ShaderData data);
ShaderInput connected(std::string name, ShaderConnection from);

}  // namespace msbvh::translate
