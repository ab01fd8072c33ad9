#include "delegate/hydra/instancer.h"

#include <algorithm>
#include <optional>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/tokens.h>

#include "delegate/hydra/motion_source.h"
#include "delegate/hydra/render_param.h"
#include "delegate/hydra/shape.h"

namespace msbvh::hydra {
namespace {

using translate::message;
using translate::PlacedLevel;
using translate::Severity;

const TfToken& angular_velocities_name() {
  static const TfToken name("angularVelocities");
  return name;
}

// One an instance; a constant one is inherited by the prototypes instead.
bool has_own_colors(HdSceneDelegate& delegate, const SdfPath& path) {
  const HdPrimvarDescriptorVector found = delegate.GetPrimvarDescriptors(path, HdInterpolationInstance);
  return std::any_of(found.begin(), found.end(), [](const HdPrimvarDescriptor& descriptor) {
    return descriptor.name == HdTokens->displayColor;
  });
}

// What is wrong with the indices of a prototype's instances; empty: nothing. `known`: how many there are.
std::string fault_of(const VtIntArray& indices, std::optional<std::size_t> known) {
  if (std::any_of(indices.cbegin(), indices.cend(), [](int index) { return index < 0; }))
    return "found a negative index, expected none";
  if (indices.empty() || !known) return "";
  const auto largest = std::size_t(*std::max_element(indices.cbegin(), indices.cend()));
  if (largest < *known) return "";
  return message("found index ", largest, ", expected less than ", *known, ", the number of its instances");
}

// One an index, or none.
std::vector<Vec3f> picked(const VtVec3fArray& every, const VtIntArray& indices) {
  std::vector<Vec3f> colors;
  for (const int index : indices) {
    if (std::size_t(index) < every.size()) colors.push_back(span_of(every)[std::size_t(index)]);
  }
  if (colors.size() != indices.size()) colors.clear();
  return colors;
}

}  // namespace

std::size_t Placed::count() const {
  std::size_t result = 1;
  for (const PlacedLevel& level : levels) result *= level.count();
  return result;
}

void Instancer::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) {
  _UpdateInstancer(delegate, bits);
  stale_ |= *bits;
  if (*bits & HdChangeTracker::DirtyVisibility) visible_ = delegate->GetVisible(GetId());
  static_cast<RenderParam*>(param)->note_instancer(*bits);
}

// More shutters than these at once come from blur scales that change from edit to edit.
constexpr std::size_t kMostShutters = 16;

Instancer::ValuesPointer Instancer::values_over(const Shutter& shutter, Diagnostics& said) {
  if (stale_ != 0 || known_.size() > kMostShutters) known_.clear();
  stale_ = 0;
  const auto found = std::find_if(known_.begin(), known_.end(),
                                  [&](const ValuesPointer& each) { return each->shutter == shutter; });
  if (found != known_.end()) return *found;
  known_.push_back(pulled(shutter, said));
  return known_.back();
}

Instancer::ValuesPointer Instancer::pulled(const Shutter& shutter, Diagnostics& said) const {
  auto values = std::make_shared<Values>();
  HdSceneDelegate& delegate = *GetDelegate();
  values->shutter = shutter;
  values->whole = instancer_motion(delegate, GetId(), shutter);
  values->shown = shutter.moving() ? timed_visibility(delegate, GetId(), shutter) : std::nullopt;
  values->matrices = instance_matrices(delegate, GetId(), shutter);
  pull_arrays(*values, said);
  return values;
}

void Instancer::pull_arrays(Values& values, Diagnostics& said) const {
  HdSceneDelegate& delegate = *GetDelegate();
  const std::string path = GetId().GetString();
  const Shutter shutter = shutter_of_rates(delegate, GetId(), values.shutter);
  const auto vectors = [&](const TfToken& name) {
    return typed<VtVec3fArray>(timed_primvar(delegate, GetId(), name, shutter, false), shutter, path,
                               name.GetString(), said);
  };
  values.translations = vectors(HdInstancerTokens->instanceTranslations);
  values.scales = vectors(HdInstancerTokens->instanceScales);
  if (has_own_colors(delegate, GetId())) values.colors = vectors(HdTokens->displayColor);
  const TfToken& turned = HdInstancerTokens->instanceRotations;
  if (!values.colors.samples.empty()) hold_frame(values.colors, path, "primvars:displayColor", said);
  values.rotations = typed<VtQuatfArray>(timed_primvar(delegate, GetId(), turned, shutter, false), shutter,
                                         path, turned.GetString(), said);
  if (shutter.moving()) {
    values.velocities = vectors(HdTokens->velocities);
    values.accelerations = vectors(HdTokens->accelerations);
    values.angular_velocities = vectors(angular_velocities_name());
  }
  values.count = std::max(
      {values.translations.at_frame.size(), values.scales.at_frame.size(), values.rotations.at_frame.size()});
  values.by_arrays = values.count > 0;
  if (!values.by_arrays) return;
  translate::PointInstancerInput& arrays = values.arrays;
  arrays.path = path;
  arrays.count = values.count;
  arrays.positions = array_samples(values.translations);
  arrays.scales = array_samples(values.scales);
  arrays.orientations = quaternion_samples(values.rotations);
  arrays.rates = {array_samples(values.velocities), array_samples(values.accelerations)};
  arrays.angular_velocities = array_samples(values.angular_velocities);
  arrays.time_remap = translate::rate_times(shutter, time_codes_per_second(delegate));
}

PlacedLevel Instancer::own_level(const ValuesPointer& values, const VtIntArray& indices,
                                 Diagnostics& said) const {
  if (values->by_arrays) {
    if (values->matrices) {
      said.push_back({Severity::kWarning, GetId().GetString(), "hydra:instanceTransforms",
                      "found matrices beside translations, rotations or scales; placed by the latter alone"});
    }
    return {nullptr,
            std::shared_ptr<translate::PointInstancerInput>(values, &values->arrays),
            {indices.cbegin(), indices.cend()}};
  }
  if (!values->matrices) {  // as many as there are indices, all in one place
    const std::vector<translate::Matrix4d> in_place(indices.size(), matrix_of(GfMatrix4d(1.0)));
    return {
        std::make_shared<translate::SampledMotion>(std::vector{0.0}, in_place, indices.size()), nullptr, {}};
  }
  std::vector<std::uint32_t> selected(indices.cbegin(), indices.cend());
  return {std::make_shared<translate::SelectedMotion>(values->matrices, std::move(selected)), nullptr, {}};
}

Placed Instancer::place(const SdfPath& prototype, const ShapeShutters& shutters, Diagnostics& said) {
  ValuesPointer values = values_over(shutters.camera, said);
  Placed placed;
  placed.shown = values->shown;
  if (!values->by_arrays && !(shutters.shape == shutters.camera)) values = values_over(shutters.shape, said);
  VtIntArray indices = GetDelegate()->GetInstanceIndices(GetId(), prototype);
  placed.visible = !indices.empty() && (placed.shown ? !placed.shown->empty() : visible_);
  const bool any = values->by_arrays || values->matrices;
  const std::size_t known = values->by_arrays ? values->count : any ? values->matrices->count() : 0;
  const std::string fault = fault_of(indices, any ? std::optional(known) : std::nullopt);
  if (!fault.empty()) {
    said.push_back({Severity::kError, GetId().GetString(), "instanceIndices",
                    fault + "; its instances of " + prototype.GetString() + " are left out"});
    placed.visible = false;
  }
  if (!placed.visible) return placed;
  placed.levels.push_back(own_level(values, indices, said));
  placed.levels.push_back({values->whole, nullptr, {}});
  placed.colors = picked(values->colors.at_frame, indices);
  if (!placed.colors.empty() && values->colors.varies) {
    for (const auto& [time01, colors] : values->colors.samples)
      placed.color_samples.emplace_back(time01, picked(colors, indices));
  }
  placed.indices.push_back(std::move(indices));
  add_parents(placed, shutters, said);
  return placed;
}

void Instancer::add_parents(Placed& placed, const ShapeShutters& shutters, Diagnostics& said) {
  if (GetParentId().IsEmpty()) return;
  auto* parent = static_cast<Instancer*>(GetDelegate()->GetRenderIndex().GetInstancer(GetParentId()));
  if (!parent) return;
  const Placed outer = parent->place(GetId(), shutters, said);
  const std::size_t inner_count = placed.count(), outer_count = outer.count();
  placed.visible = placed.visible && outer.visible;
  if (!placed.visible) return;
  placed.shown = translate::common_intervals(placed.shown, outer.shown);
  const bool own = !placed.colors.empty();
  // Every outer instance has all inner ones.
  const auto spread = [&](const std::vector<Vec3f>& from) {
    std::vector<Vec3f> colors;
    for (std::size_t i = 0; i < outer_count && !from.empty(); ++i) {
      if (own) {
        colors.insert(colors.end(), from.begin(), from.end());
      } else {
        colors.insert(colors.end(), inner_count, from[i]);
      }
    }
    return colors;
  };
  std::vector<std::pair<double, std::vector<Vec3f>>> samples;
  for (const auto& [time01, colors] : own ? placed.color_samples : outer.color_samples)
    samples.emplace_back(time01, spread(colors));
  placed.colors = spread(own ? placed.colors : outer.colors);
  placed.color_samples = std::move(samples);
  placed.levels.insert(placed.levels.end(), outer.levels.begin(), outer.levels.end());
  placed.indices.insert(placed.indices.end(), outer.indices.begin(), outer.indices.end());
}

}  // namespace msbvh::hydra
