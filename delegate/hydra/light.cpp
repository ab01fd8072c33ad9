#include "delegate/hydra/light.h"

#include <algorithm>
#include <cmath>
#include <pxr/imaging/hd/lightSchema.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/tokens.h>
#include <pxr/usd/usdLux/blackbody.h>

#include "delegate/hydra/instancer.h"
#include "delegate/hydra/light_look.h"
#include "delegate/hydra/render_param.h"
#include "delegate/translate/frame/array_motion.h"
#include "delegate/translate/look/light_radiance.h"
#include "delegate/translate/sample/value_times.h"

namespace msbvh::hydra {
namespace {

using translate::FrameLight;
using translate::LightNumbers;
using translate::LightSamples;
using translate::message;
using translate::Severity;

std::optional<LightKind> kind_of(const TfToken& type) {
  if (type == HdPrimTypeTokens->distantLight) return LightKind::kDistant;
  if (type == HdPrimTypeTokens->domeLight) return LightKind::kDome;
  if (type == HdPrimTypeTokens->sphereLight) return LightKind::kSphere;
  if (type == HdPrimTypeTokens->rectLight) return LightKind::kRect;
  if (type == HdPrimTypeTokens->diskLight) return LightKind::kDisk;
  if (type == HdPrimTypeTokens->cylinderLight) return LightKind::kCylinder;
  return std::nullopt;
}

// What moves a light's values.
TfTokenVector value_names() {
  const auto& t = HdLightTokens;
  TfTokenVector names{t->intensity,        t->exposure, t->color, t->enableColorTemperature,
                      t->colorTemperature, t->normalize};
  for (const translate::LightNumber& each : translate::kLightNumbers) names.emplace_back(each.input);
  return names;
}

std::optional<double> as_number(const VtValue& value) {
  if (value.IsHolding<float>()) return double(value.UncheckedGet<float>());
  if (value.IsHolding<double>()) return value.UncheckedGet<double>();
  if (value.IsHolding<int>()) return double(value.UncheckedGet<int>());
  return std::nullopt;
}

Vec3d as_color(const VtValue& value) {
  if (!value.IsHolding<GfVec3f>()) return {1.0, 1.0, 1.0};
  const GfVec3f& color = value.UncheckedGet<GfVec3f>();
  return {double(color[0]), double(color[1]), double(color[2])};
}

bool as_flag(const VtValue& value) { return value.IsHolding<bool>() && value.UncheckedGet<bool>(); }

}  // namespace

const TfTokenVector& Light::types() {
  static const TfTokenVector all = HdLightPrimTypeTokens();
  return all;
}

void Light::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) {
  _UpdateInstancer(delegate, bits);
  delegate_ = delegate;
  if (*bits & HdLight::DirtyParams) visible_ = delegate->GetVisible(GetId());
  static_cast<RenderParam*>(param)->note_light(*this);
  *bits = HdLight::Clean;
}

void Light::Finalize(HdRenderParam* param) { static_cast<RenderParam*>(param)->forget_light(*this); }

// HdxTaskController's: it stands for usdrecord's light at the camera, and is distant, or a simple light, for
// want of another type.
bool Light::is_hosts_own() const {
  const bool may_be = type_ == HdPrimTypeTokens->distantLight || type_ == HdPrimTypeTokens->simpleLight;
  return may_be &&
         delegate_->GetLightParamValue(GetId(), HdLightTokens->params).GetTypeName() == "GlfSimpleLight";
}

VtValue Light::parameter(const TfToken& name, float offset) const {
  if (const HdContainerDataSourceHandle prim = scene_index_prim(*delegate_, GetId())) {
    const HdContainerDataSourceHandle light = HdLightSchema::GetFromParent(prim).GetContainer();
    const auto source = light ? HdSampledDataSource::Cast(light->Get(name)) : nullptr;
    if (source) return source->GetValue(offset);
  }
  return delegate_->GetLightParamValue(GetId(), name);
}

double Light::number(const TfToken& name, float offset, double fallback, Diagnostics& said) const {
  const VtValue value = parameter(name, offset);
  if (value.IsEmpty()) return fallback;
  if (const std::optional<double> found = as_number(value)) return *found;
  said.push_back({Severity::kWarning, GetId().GetString(), "inputs:" + name.GetString(),
                  message("found ", value.GetTypeName(), ", expected a number; took ", fallback)});
  return fallback;
}

LightSamples Light::samples_at(std::span<const double> times01, std::span<const double> read_at01,
                               const Shutter& shutter, Diagnostics& said) const {
  const LightNumbers standard;
  const auto& t = HdLightTokens;
  LightSamples samples;
  samples.times01.assign(times01.begin(), times01.end());
  for (const double time01 : read_at01) {
    const auto offset = float(shutter.frames_at(time01));
    Vec3d temperature{1.0, 1.0, 1.0};
    const double kelvin = number(t->colorTemperature, offset, 6500.0, said);
    if (as_flag(parameter(t->enableColorTemperature, offset)) && std::isfinite(kelvin)) {
      const GfVec3f rgb = UsdLuxBlackbodyTemperatureAsRgb(float(kelvin));
      temperature = {double(rgb[0]), double(rgb[1]), double(rgb[2])};
    }
    samples.emission.push_back(translate::light_emission(number(t->intensity, offset, 1.0, said),
                                                         number(t->exposure, offset, 0.0, said),
                                                         as_color(parameter(t->color, offset)), temperature));
    LightNumbers& numbers = samples.numbers.emplace_back();
    for (const translate::LightNumber& each : translate::kLightNumbers)
      numbers.*each.number = number(TfToken(each.input), offset, standard.*each.number, said);
    samples.normalize.push_back(as_flag(parameter(t->normalize, offset)));
  }
  return samples;
}

translate::SampledLight Light::sampled(const Shutter& shutter, Diagnostics& said) const {
  const double frame01 = shutter.frame01(), first = 0.0;
  const LightSamples at_frame = samples_at(std::span(&first, 1), std::span(&frame01, 1), shutter, said);
  std::vector<double> authored01;
  const HdContainerDataSourceHandle prim = scene_index_prim(*delegate_, GetId());
  const HdContainerDataSourceHandle light =
      prim ? HdLightSchema::GetFromParent(prim).GetContainer() : nullptr;
  for (const TfToken& name : value_names()) {
    const auto source = light ? HdSampledDataSource::Cast(light->Get(name)) : nullptr;
    if (!source) continue;
    for (const float offset : contributing_offsets(*source, shutter))
      authored01.push_back(shutter.time01(double(offset)));
  }
  if (authored01.empty()) return translate::SampledLight(at_frame);
  std::erase_if(authored01, [](double time01) { return !(time01 > 0.0 && time01 < 1.0); });
  std::vector<double> times01, read_at01;
  for (const translate::ValueTime& time : translate::value_times(authored01, {})) {
    times01.push_back(time.time01);
    read_at01.push_back(time.read_at01);
  }
  const translate::LightSwitches always{std::vector<bool>(times01.size(), true), std::nullopt};
  return {at_frame, samples_at(times01, read_at01, shutter, said), always};
}

MotionPointer Light::motion(const Shutter& shutter, Diagnostics& said) {
  const MotionPointer own = transform_motion(*delegate_, GetId(), shutter);
  if (GetInstancerId().IsEmpty()) return own;
  HdRenderIndex& index = delegate_->GetRenderIndex();
  HdInstancer::_SyncInstancerAndParents(index, GetInstancerId());
  auto* instancer = static_cast<Instancer*>(index.GetInstancer(GetInstancerId()));
  if (!instancer) return own;
  const Placed placed = instancer->place(GetId(), {shutter, shutter}, said);
  if (!placed.visible) return nullptr;
  translate::PrimLog log(said, GetId().GetString());
  MotionPointer all = own;
  for (const translate::PlacedLevel& level : placed.levels) {
    const MotionPointer places = translate::motion_of(level, log);
    if (!places) return nullptr;
    all = std::make_shared<translate::NestedMotion>(all, places);
  }
  return all;
}

std::string Light::link(const TfToken& name) const {
  const VtValue link = delegate_ ? delegate_->GetLightParamValue(GetId(), name) : VtValue();
  return link.IsHolding<TfToken>() ? link.UncheckedGet<TfToken>().GetString() : std::string();
}

std::optional<FrameLight> Light::frame_light(const Shutter& shutter, const Textures& textures,
                                             bool& is_camera_light, Diagnostics& said) {
  if (!delegate_ || !visible_) return std::nullopt;
  if (is_hosts_own()) {
    is_camera_light = true;
    return std::nullopt;
  }
  const std::optional<LightKind> kind = kind_of(type_);
  if (!kind) {
    said.push_back({Severity::kWarning, GetId().GetString(), "",
                    "lights of type " + type_.GetString() + " are not supported yet; left out", true});
    return std::nullopt;
  }
  const MotionPointer moves = motion(shutter, said);
  if (!moves) return std::nullopt;
  const LightParameter at_frame = [this](const TfToken& name) { return parameter(name, 0.0f); };
  FrameLight light{GetId().GetString(), *kind, sampled(shutter, said), moves,
                   light_look(GetId().GetString(), *kind, at_frame, textures, said)};
  const VtValue offset = parameter(HdLightTokens->domeOffset, 0.0f);
  if (*kind == LightKind::kDome && offset.IsHolding<GfMatrix4d>()) {
    const GfMatrix4d& m = offset.UncheckedGet<GfMatrix4d>();
    if (m != GfMatrix4d(1.0)) std::copy_n(m.GetArray(), 16, light.offset.emplace().begin());
  }
  return light;
}

}  // namespace msbvh::hydra
