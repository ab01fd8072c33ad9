#include "delegate/translate/look/shader_network.h"

#include <algorithm>

namespace msbvh::translate {

const ShaderInput* ShaderNode::input(std::string_view name) const {
  const auto found = std::ranges::find(inputs, name, &ShaderInput::name);
  return found == inputs.end() ? nullptr : &*found;
}

const ShaderNode* ShaderNetwork::node(std::string_view node_path) const {
  const auto found = std::ranges::find(nodes, node_path, &ShaderNode::path);
  return found == nodes.end() ? nullptr : &*found;
}

}  // namespace msbvh::translate
