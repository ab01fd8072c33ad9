#include "delegate/hydra/implicit.h"

#include <algorithm>
#include <limits>
#include <pxr/imaging/hd/tokens.h>

#include "delegate/translate/frame/held_values.h"

namespace msbvh::hydra {
namespace {

using translate::ImplicitKind;

// A container of the prim's, named as its type is, has one data source for each attribute.
struct Attributes {
  HdContainerDataSourceHandle container;

  HdSampledDataSourceHandle find(std::string_view name) const {
    return container ? HdSampledDataSource::Cast(container->Get(TfToken(std::string(name)))) : nullptr;
  }
  bool has(std::string_view name) const { return find(name) != nullptr; }
};

// Those with a radius at each end are types of their own in USD.
ImplicitKind kind_of(const TfToken& type, const Attributes& attributes) {
  const bool two_radii = attributes.has("radiusTop");
  if (type == HdPrimTypeTokens->sphere) return ImplicitKind::kSphere;
  if (type == HdPrimTypeTokens->cube) return ImplicitKind::kCube;
  if (type == HdPrimTypeTokens->cone) return ImplicitKind::kCone;
  if (type == HdPrimTypeTokens->cylinder)
    return two_radii ? ImplicitKind::kCylinder1 : ImplicitKind::kCylinder;
  if (type == HdPrimTypeTokens->capsule) return two_radii ? ImplicitKind::kCapsule1 : ImplicitKind::kCapsule;
  return ImplicitKind::kPlane;
}

std::string axis_of(const Attributes& attributes) {
  const HdSampledDataSourceHandle axis = attributes.find("axis");
  const VtValue value = axis ? axis->GetValue(0.0f) : VtValue();
  return value.IsHolding<TfToken>() ? value.UncheckedGet<TfToken>().GetString() : "Z";
}

// NaN, which the translator names, for a parameter that is missing or no number.
double number_at(const HdSampledDataSourceHandle& source, float offset) {
  const VtValue value = source ? VtValue::Cast<double>(source->GetValue(offset)) : VtValue();
  return value.IsHolding<double>() ? value.UncheckedGet<double>() : std::numeric_limits<double>::quiet_NaN();
}

struct Parameters {
  std::vector<HdSampledDataSourceHandle> sources;

  std::vector<double> at(float offset) const {
    std::vector<double> values;
    for (const HdSampledDataSourceHandle& source : sources) values.push_back(number_at(source, offset));
    return values;
  }

  // Where any of them is sampled; none where all stay as they are.
  std::vector<float> offsets(const Shutter& shutter) const {
    std::vector<float> all;
    for (const HdSampledDataSourceHandle& source : sources) {
      const std::vector<float> own = source ? contributing_offsets(*source, shutter) : std::vector<float>();
      if (own.size() > 1) all.insert(all.end(), own.begin(), own.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
};

}  // namespace

const TfTokenVector& implicit_types() {
  static const TfTokenVector types{HdPrimTypeTokens->sphere,  HdPrimTypeTokens->cube,
                                   HdPrimTypeTokens->cone,    HdPrimTypeTokens->cylinder,
                                   HdPrimTypeTokens->capsule, HdPrimTypeTokens->plane};
  return types;
}

bool ImplicitValues::pull_topology(HdSceneDelegate& delegate, const Shutter& shutter) {
  const HdContainerDataSourceHandle prim = scene_index_prim(delegate, path());
  const Attributes attributes{prim ? HdContainerDataSource::Cast(prim->Get(type_)) : nullptr};
  translate::ImplicitFrameInput input;
  input.shape.path = path().GetString();
  input.shape.kind = kind_of(type_, attributes);
  input.shape.axis = axis_of(attributes);
  Parameters parameters;
  for (const std::string_view name : translate::implicit_type(input.shape.kind).parameters)
    parameters.sources.push_back(attributes.find(name));
  input.shape.values.push_back(parameters.at(0.0f));
  const std::vector<float> offsets = parameters.offsets(shutter);
  for (const float offset : offsets) {
    input.times01.push_back(shutter.time01(double(offset)));
    input.shape.values.push_back(parameters.at(offset));
  }
  input.held = translate::holds_between(std::vector<double>(offsets.begin(), offsets.end()),
                                        [&](double offset) { return parameters.at(float(offset)); });
  input_ = std::move(input);
  return false;
}

const TfTokenVector& Implicit::GetBuiltinPrimvarNames() const {
  static const TfTokenVector none;
  return none;
}

}  // namespace msbvh::hydra
