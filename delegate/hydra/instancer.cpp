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
  if (!arrays_) {
    std::vector<std::uint32_t> selected(indices.cbegin(), indices.cend());
    return {std::make_shared<translate::SelectedMotion>(matrices_, std::move(selected)), nullptr, {}};
  }
  if (matrices_) {
    said.push_back({Severity::kWarning, GetId().GetString(), "hydra:instanceTransforms",
                    "found matrices beside translations, rotations or scales; placed by the latter alone"});
  }
  return {nullptr, arrays_, {indices.cbegin(), indices.cend()}};
}

Placed Instancer::place(const SdfPath& prototype, const Shutter& shutter, Diagnostics& said) {
  pull(shutter, said);
  HdSceneDelegate& delegate = *GetDelegate();
  const std::string path = GetId().GetString();
  VtIntArray indices = delegate.GetInstanceIndices(GetId(), prototype);
  const bool below = std::any_of(indices.cbegin(), indices.cend(), [](int index) { return index < 0; });
  Placed placed;
  placed.visible = visible_;
  if (indices.empty() || below || (arrays_ && largest_index(indices) >= count_)) {
    if (!indices.empty()) {
      said.push_back(
          {Severity::kError, path, "instanceIndices",
           message("found ", below ? "a negative index" : "an index too large", ", expected less than ",
                   count_, "; its instances of ", prototype.GetString(), " are left out")});
    }
    placed.visible = false;
    return placed;
  }
  matrices_ = instance_matrices(delegate, GetId(), largest_index(indices) + 1, shutter_);
  if (!arrays_ && !matrices_) {  // as many as there are indices, all in one place
    matrices_ = std::make_shared<translate::SampledMotion>(
        std::vector{0.0}, std::vector(largest_index(indices) + 1, matrix_of(GfMatrix4d(1.0))),
        largest_index(indices) + 1);
  }
  placed.levels.push_back(own_level(indices, said));
  placed.levels.push_back({whole_, nullptr, {}});
  for (const int index : indices) {
    if (std::size_t(index) < colors_.at_frame.size())
      placed.colors.push_back(span_of(colors_.at_frame)[std::size_t(index)]);
  }
  if (placed.colors.size() != indices.size()) placed.colors.clear();
  placed.indices.push_back(std::move(indices));
  add_parents(placed, shutter, said);
  return placed;
}

void Instancer::add_parents(Placed& placed, const Shutter& shutter, Diagnostics& said) {
  if (GetParentId().IsEmpty()) return;
  auto* parent = static_cast<Instancer*>(GetDelegate()->GetRenderIndex().GetInstancer(GetParentId()));
  if (!parent) return;
  const Placed outer = parent->place(GetId(), shutter, said);
  const std::size_t inner_count = placed.count(), outer_count = outer.count();
  placed.visible = placed.visible && outer.visible;
  if (!placed.visible) return;
  std::vector<Vec3f> colors;
  for (std::size_t i = 0; i < outer_count; ++i) {
    if (!placed.colors.empty()) {
      colors.insert(colors.end(), placed.colors.begin(), placed.colors.end());
    } else if (!outer.colors.empty()) {
      colors.insert(colors.end(), inner_count, outer.colors[i]);
    }
  }
  placed.colors = std::move(colors);
  placed.levels.insert(placed.levels.end(), outer.levels.begin(), outer.levels.end());
  placed.indices.insert(placed.indices.end(), outer.indices.begin(), outer.indices.end());
}

}  // namespace msbvh::hydra
