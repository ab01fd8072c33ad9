#include "delegate/hydra/render_settings.h"

#include <algorithm>
#include <cstdint>
#include <pxr/base/gf/half.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/tokens.h>
#include <pxr/imaging/hd/utils.h>
#include <string>
#include <utility>
#include <vector>

#include "core/texture/plain_color.h"

namespace msbvh::hydra {
namespace {

using translate::message;
using translate::Severity;

translate::SettingValue setting_value(const VtValue& value) {
  if (value.IsHolding<bool>()) return value.UncheckedGet<bool>();
  if (value.IsHolding<std::string>()) return value.UncheckedGet<std::string>();
  if (value.IsHolding<TfToken>()) return value.UncheckedGet<TfToken>().GetString();
  const bool real = value.IsHolding<float>() || value.IsHolding<double>() || value.IsHolding<GfHalf>();
  if (real) return VtValue::Cast<double>(value).UncheckedGet<double>();
  const bool whole = value.IsHolding<int>() || value.IsHolding<unsigned>() || value.IsHolding<std::int64_t>();
  if (whole) return VtValue::Cast<std::int64_t>(value).UncheckedGet<std::int64_t>();
  return {};
}

std::vector<translate::NamedSetting> named_settings(const VtDictionary& settings) {
  std::vector<translate::NamedSetting> named;
  for (const auto& [name, value] : settings)
    named.push_back({name, setting_value(value), value.GetTypeName()});
  return named;
}

std::vector<std::string> names_of(const VtArray<TfToken>& tokens) {
  std::vector<std::string> names;
  for (const TfToken& token : tokens) names.push_back(token.GetString());
  return names;
}

// Hydra's products have inherited what they do not author.
translate::RenderProductInput product_input(const HdRenderSettings::RenderProduct& product) {
  translate::RenderProductInput input;
  translate::RenderBaseInput& base = input.base;
  base.path = product.productPath.GetString();
  base.camera = product.cameraPath.GetString();
  base.resolution = {product.resolution[0], product.resolution[1]};
  base.pixel_aspect_ratio = double(product.pixelAspectRatio);
  if (!product.aspectRatioConformPolicy.IsEmpty())
    base.aspect_ratio_conform_policy = product.aspectRatioConformPolicy.GetString();
  const GfRange2f& window = product.dataWindowNDC;
  base.data_window_ndc = {window.GetMin()[0], window.GetMin()[1], window.GetMax()[0], window.GetMax()[1]};
  base.disable_motion_blur = product.disableMotionBlur;
  base.disable_depth_of_field = product.disableDepthOfField;
  base.settings = named_settings(product.namespacedSettings);
  if (!product.type.IsEmpty()) input.product_type = product.type.GetString();
  input.product_name = product.name.GetString();
  for (const HdRenderSettings::RenderProduct::RenderVar& var : product.renderVars) {
    input.ordered_vars.push_back(
        {var.varPath.GetString(), var.dataType.GetString(), var.sourceName, var.sourceType.GetString()});
  }
  return input;
}

translate::RenderSettingsInput settings_input(const HdRenderSettings& prim) {
  translate::RenderSettingsInput input;
  input.base.path = prim.GetId().GetString();
  input.base.settings = named_settings(prim.GetNamespacedSettings());
  for (const HdRenderSettings::RenderProduct& product : prim.GetRenderProducts())
    input.products.push_back(product_input(product));
  if (!prim.GetMaterialBindingPurposes().empty())
    input.material_binding_purposes = names_of(prim.GetMaterialBindingPurposes());
  if (!prim.GetRenderingColorSpace().IsEmpty())
    input.rendering_color_space = prim.GetRenderingColorSpace().GetString();
  return input;
}

// The first that is seen through that camera; else the first.
const translate::ProductSpec* product_for(const translate::RenderSpec& spec, const SdfPath& camera) {
  const auto found = std::find_if(spec.products.begin(), spec.products.end(),
                                  [&](const auto& product) { return product.camera == camera.GetString(); });
  if (found != spec.products.end()) return &*found;
  return spec.products.empty() ? nullptr : &spec.products.front();
}

void tell_unwritten(const translate::RenderSpec& spec, const std::string& path, Diagnostics& said) {
  for (const translate::ProductSpec& product : spec.products) {
    said.push_back(
        {Severity::kWarning, product.path, "",
         message("product '", product.name,
                 "' is not written: the host's render pass says what is rendered, and where it goes")});
  }
  if (!spec.rendering_space.empty() && spec.rendering_space != kLinearRec709) {
    said.push_back({Severity::kWarning, path, "renderingColorSpace",
                    message("found '", spec.rendering_space, "', expected ", kLinearRec709,
                            ", the only space that the plugin renders in")});
  }
  if (spec.material_purpose != HdTokens->full.GetString()) {
    said.push_back({Severity::kWarning, path, "materialBindingPurposes",
                    message("found '", spec.material_purpose, "' first, expected full; full is bound")});
  }
}

template <typename To, typename From>
void take(To& to, const std::optional<From>& from) {
  if (from) to = To(*from);
}

}  // namespace

void SettingsPrim::_Sync(HdSceneDelegate*, HdRenderParam* param, const HdDirtyBits* bits) {
  if (*bits & HdRenderSettings::AllDirty) static_cast<RenderParam*>(param)->note_settings();
}

const SettingsPrim* active_settings(HdRenderIndex& index) {
  SdfPath path;
  if (!HdUtils::HasActiveRenderSettingsPrim(index.GetTerminalSceneIndex(), &path)) return nullptr;
  return dynamic_cast<const SettingsPrim*>(index.GetBprim(HdPrimTypeTokens->renderSettings, path));
}

PassSettings pass_settings(const SettingsPrim& prim, const SdfPath& camera, Diagnostics& said) {
  const translate::RenderSpec spec = translate::render_spec(settings_input(prim), said);
  tell_unwritten(spec, prim.GetId().GetString(), said);
  PassSettings wanted;
  if (const translate::ProductSpec* product = product_for(spec, camera)) {
    wanted.motion_blur = product->motion_blur;
    wanted.depth_of_field = product->depth_of_field;
  }
  wanted.own = spec.own;
  return wanted;
}

void apply(const PassSettings& wanted, Settings& settings) {
  const translate::OwnSettings& own = wanted.own;
  settings.depth_of_field = wanted.depth_of_field;
  if (own.noise && *own.noise > 0.0 && !own.samples) settings.render.spp = translate::kMostSamplesOfNoise;
  take(settings.render.spp, own.samples);
  take(settings.render.noise.target, own.noise);
  take(settings.render.seed, own.seed);
  take(settings.render.max_bounces, own.max_bounces);
  take(settings.render.refraction, own.refraction);
  take(settings.translate.motion_tolerance_pixels, own.motion_tolerance);
  take(settings.translate.edge_length_pixels, own.edge_length);
  take(settings.translate.choice.segments, own.segments);
  const std::pair<const char*, std::optional<std::string>> choices[] = {
      {"msbvh:interpolation", own.interpolation},
      {"msbvh:builder", own.builder},
      {"msbvh:layout", own.layout}};
  for (const auto& [key, name] : choices) {
    if (name) set_choice(settings, TfToken(key), *name);
  }
}

}  // namespace msbvh::hydra
