#include "delegate/hydra/instancer.h"

#include <algorithm>
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

std::size_t largest_index(const VtIntArray& indices) {
  return indices.empty() ? 0 : std::size_t(*std::max_element(indices.cbegin(), indices.cend()));
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

void Instancer::pull(const Shutter& shutter, Diagnostics& said) {
  if (read_ && stale_ == 0 && shutter_ == shutter) return;
  shutter_ = shutter;
  HdSceneDelegate& delegate = *GetDelegate();
  whole_ = instancer_motion(delegate, GetId(), shutter_);
  shown_ = shutter_.moving() ? timed_visibility(delegate, GetId(), shutter_) : std::nullopt;
  matrices_ = instance_matrices(delegate, GetId(), shutter_);
  pull_arrays(delegate, said);
  read_ = true;
  stale_ = 0;
}

void Instancer::pull_arrays(HdSceneDelegate& delegate, Diagnostics& said) {
  const std::string path = GetId().GetString();
  const auto vectors = [&](const TfToken& name) {
    return typed<VtVec3fArray>(timed_primvar(delegate, GetId(), name, shutter_, false), shutter_, path,
                               name.GetString(), said);
  };
  translations_ = vectors(HdInstancerTokens->instanceTranslations);
  scales_ = vectors(HdInstancerTokens->instanceScales);
  colors_ = has_own_colors(delegate, GetId()) ? vectors(HdTokens->displayColor) : TypedValues<VtVec3fArray>{};
  const TfToken& turned = HdInstancerTokens->instanceRotations;
  if (!colors_.samples.empty()) hold_frame(colors_, path, "primvars:displayColor", said);
  rotations_ = typed<VtQuatfArray>(timed_primvar(delegate, GetId(), turned, shutter_, false), shutter_, path,
                                   turned.GetString(), said);
  velocities_ = accelerations_ = angular_velocities_ = {};
  if (shutter_.moving()) {
    velocities_ = vectors(HdTokens->velocities);
    accelerations_ = vectors(HdTokens->accelerations);
    angular_velocities_ = vectors(angular_velocities_name());
  }
  count_ = std::max({translations_.at_frame.size(), scales_.at_frame.size(), rotations_.at_frame.size()});
  arrays_.reset();
  if (count_ == 0) return;
  arrays_ = std::make_shared<translate::PointInstancerInput>();
  arrays_->path = path;
  arrays_->count = count_;
  arrays_->positions = array_samples(translations_);
  arrays_->scales = array_samples(scales_);
  arrays_->orientations = quaternion_samples(rotations_);
  arrays_->rates = {array_samples(velocities_), array_samples(accelerations_)};
  arrays_->angular_velocities = array_samples(angular_velocities_);
  arrays_->time_remap = translate::rate_times(shutter_, time_codes_per_second(delegate));
}

PlacedLevel Instancer::own_level(const VtIntArray& indices, Diagnostics& said) const {
  if (arrays_) {
    if (matrices_) {
      said.push_back({Severity::kWarning, GetId().GetString(), "hydra:instanceTransforms",
                      "found matrices beside translations, rotations or scales; placed by the latter alone"});
    }
    return {nullptr, arrays_, {indices.cbegin(), indices.cend()}};
  }
  if (!matrices_) {  // as many as there are indices, all in one place
    const std::vector<translate::Matrix4d> in_place(indices.size(), matrix_of(GfMatrix4d(1.0)));
    return {
        std::make_shared<translate::SampledMotion>(std::vector{0.0}, in_place, indices.size()), nullptr, {}};
  }
  std::vector<std::uint32_t> selected(indices.cbegin(), indices.cend());
  return {std::make_shared<translate::SelectedMotion>(matrices_, std::move(selected)), nullptr, {}};
}

// What is wrong with the indices of a prototype's instances; empty: nothing.
std::string Instancer::fault_of(const VtIntArray& indices) const {
  if (std::any_of(indices.cbegin(), indices.cend(), [](int index) { return index < 0; }))
    return "found a negative index, expected none";
  const std::size_t known = arrays_ ? count_ : matrices_ ? matrices_->count() : indices.size();
  const std::size_t largest = largest_index(indices);
  if (largest < known || (!arrays_ && !matrices_)) return "";
  return message("found index ", largest, ", expected less than ", known, ", the number of its instances");
}

Placed Instancer::place(const SdfPath& prototype, const Shutter& shutter, Diagnostics& said) {
  pull(shutter, said);
  VtIntArray indices = GetDelegate()->GetInstanceIndices(GetId(), prototype);
  Placed placed;
  placed.visible = !indices.empty() && (shown_ ? !shown_->empty() : visible_);
  placed.shown = shown_;
  const std::string fault = fault_of(indices);
  if (!fault.empty()) {
    said.push_back({Severity::kError, GetId().GetString(), "instanceIndices",
                    fault + "; its instances of " + prototype.GetString() + " are left out"});
    placed.visible = false;
  }
  if (!placed.visible) return placed;
  placed.levels.push_back(own_level(indices, said));
  placed.levels.push_back({whole_, nullptr, {}});
  add_colors(indices, placed);
  placed.indices.push_back(std::move(indices));
  add_parents(placed, shutter, said);
  return placed;
}

void Instancer::add_colors(const VtIntArray& indices, Placed& placed) const {
  const auto picked = [&](const VtVec3fArray& every) {
    std::vector<Vec3f> colors;
    for (const int index : indices) {
      if (std::size_t(index) < every.size()) colors.push_back(span_of(every)[std::size_t(index)]);
    }
    if (colors.size() != indices.size()) colors.clear();
    return colors;
  };
  placed.colors = picked(colors_.at_frame);
  if (placed.colors.empty() || !colors_.varies) return;
  for (const auto& [time01, colors] : colors_.samples)
    placed.color_samples.emplace_back(time01, picked(colors));
}

void Instancer::add_parents(Placed& placed, const Shutter& shutter, Diagnostics& said) {
  if (GetParentId().IsEmpty()) return;
  auto* parent = static_cast<Instancer*>(GetDelegate()->GetRenderIndex().GetInstancer(GetParentId()));
  if (!parent) return;
  const Placed outer = parent->place(GetId(), shutter, said);
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
