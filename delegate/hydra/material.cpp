#include "delegate/hydra/material.h"

#include <pxr/base/gf/vec2f.h>
#include <pxr/base/gf/vec3f.h>
#include <pxr/base/gf/vec4f.h>
#include <pxr/base/tf/stringUtils.h>
#include <pxr/imaging/hd/sceneDelegate.h>
#include <pxr/usd/ar/resolver.h>
#include <pxr/usd/sdf/assetPath.h>

#include "core/base/error.h"
#include "core/texture/plain_color.h"
#include "delegate/hydra/render_param.h"

namespace msbvh::hydra {
namespace {

using translate::Asset;
using translate::ShaderConnection;
using translate::ShaderData;
using translate::ShaderInput;
using translate::ShaderNode;

constexpr std::string_view kTileToken = "<UDIM>";

template <typename Vector>
ShaderData numbers(const VtValue& value) {
  const Vector& from = value.UncheckedGet<Vector>();
  std::vector<double> to;
  for (std::size_t i = 0; i < Vector::dimension; ++i) to.push_back(double(from[i]));
  return to;
}

// The tiles of a UDIM texture, of which hosts resolve the pattern alone.
std::vector<std::string> tiles(const std::string& pattern, std::size_t token) {
  std::vector<std::string> found;
  for (int tile = 1001; tile <= 1100; ++tile) {
    const std::string path = std::string(pattern).replace(token, kTileToken.size(), std::to_string(tile));
    const ArResolvedPath resolved = ArGetResolver().Resolve(path);
    if (!resolved.empty()) found.push_back(resolved.GetPathString());
  }
  return found;
}

ShaderData asset(const SdfAssetPath& path) {
  Asset result{path.GetAssetPath()};
  const std::string& resolved = path.GetResolvedPath().empty() ? path.GetAssetPath() : path.GetResolvedPath();
  const std::size_t token = resolved.find(kTileToken);
  if (token != std::string::npos) {
    result.files = tiles(resolved, token);
  } else if (!path.GetResolvedPath().empty()) {
    result.files.push_back(path.GetResolvedPath());
  }
  return result;
}

// UsdImaging hands what the stage says of a file's colours down as a parameter beside it.
std::string color_space_of(const HdMaterialNode2& node, const TfToken& name) {
  const auto found = node.parameters.find(TfToken("colorSpace:" + name.GetString()));
  if (found == node.parameters.end() || !found->second.IsHolding<TfToken>()) return {};
  return found->second.UncheckedGet<TfToken>().GetString();
}

ShaderData data_of(const VtValue& value) {
  if (value.IsHolding<bool>()) return value.UncheckedGet<bool>();
  if (value.IsHolding<float>()) return double(value.UncheckedGet<float>());
  if (value.IsHolding<double>()) return value.UncheckedGet<double>();
  if (value.IsHolding<int>()) return double(value.UncheckedGet<int>());
  if (value.IsHolding<GfVec2f>()) return numbers<GfVec2f>(value);
  if (value.IsHolding<GfVec3f>()) return numbers<GfVec3f>(value);
  if (value.IsHolding<GfVec4f>()) return numbers<GfVec4f>(value);
  if (value.IsHolding<TfToken>()) return value.UncheckedGet<TfToken>().GetString();
  if (value.IsHolding<std::string>()) return value.UncheckedGet<std::string>();
  if (value.IsHolding<SdfAssetPath>()) return asset(value.UncheckedGet<SdfAssetPath>());
  return std::monostate{};
}

// A colour that something is said about, of three numbers. One of no known space stays as it is.
void to_rendering_space(std::vector<double>& color, const std::string& space) {
  if (color.size() != 3) return;
  std::vector<float> rgb(color.begin(), color.end());
  try {
    convert_colors(rgb, space, kLinearRec709);
    color.assign(rgb.begin(), rgb.end());
  } catch (const Error&) {
  }
}

ShaderNode node_of(const SdfPath& path, const HdMaterialNode2& from) {
  ShaderNode node{path.GetString(), from.nodeTypeId.GetString(), {}};
  for (const auto& [name, sources] : from.inputConnections) {
    ShaderInput input{name.GetString()};
    for (const HdMaterialConnection2& source : sources)
      input.connections.push_back({source.upstreamNode.GetString(), source.upstreamOutputName.GetString()});
    node.inputs.push_back(std::move(input));
  }
  for (const auto& [name, value] : from.parameters) {
    if (from.inputConnections.contains(name)) continue;
    ShaderInput input{name.GetString()};
    input.value = {data_of(value), TfStringify(value), value.GetTypeName()};
    const std::string space = color_space_of(from, name);
    if (auto* file = std::get_if<Asset>(&input.value->data)) file->color_space = space;
    if (auto* color = std::get_if<std::vector<double>>(&input.value->data); color && !space.empty())
      to_rendering_space(*color, space);
    node.inputs.push_back(std::move(input));
  }
  return node;
}

translate::ShaderNetwork network_of(const SdfPath& path, const HdMaterialNetwork2& from) {
  translate::ShaderNetwork network;
  network.path = path.GetString();
  for (const auto& [name, node] : from.nodes) network.nodes.push_back(node_of(name, node));
  for (const auto& [name, source] : from.terminals) {
    network.terminals[name.GetString()] = {source.upstreamNode.GetString(),
                                           source.upstreamOutputName.GetString()};
  }
  return network;
}

}  // namespace

void Material::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) {
  if (*bits & (HdMaterial::DirtyResource | HdMaterial::DirtyParams)) {
    const VtValue resource = delegate->GetMaterialResource(GetId());
    network_ = {};
    network_.path = GetId().GetString();
    if (resource.IsHolding<HdMaterialNetworkMap>()) {
      const auto& map = resource.UncheckedGet<HdMaterialNetworkMap>();
      network_ = network_of(GetId(), HdConvertToHdMaterialNetwork2(map));
    }
  }
  static_cast<RenderParam*>(param)->note_material(*this);
  *bits = HdMaterial::Clean;
}

void Material::Finalize(HdRenderParam* param) { static_cast<RenderParam*>(param)->forget_material(*this); }

}  // namespace msbvh::hydra
