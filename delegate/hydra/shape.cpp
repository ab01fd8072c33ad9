#include "delegate/hydra/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <pxr/imaging/hd/primvarsSchema.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/imaging/hd/sceneIndex.h>
#include <pxr/imaging/hd/tokens.h>

#include "delegate/hydra/motion_source.h"
#include "delegate/hydra/render_param.h"
#include "delegate/translate/frame/motion_scale.h"

namespace msbvh::hydra {
namespace {

constexpr std::array kInterpolations{HdInterpolationConstant, HdInterpolationUniform, HdInterpolationVarying,
                                     HdInterpolationVertex, HdInterpolationFaceVarying};
constexpr HdDirtyBits kPointBits = HdChangeTracker::DirtyPoints | HdChangeTracker::DirtyTopology |
                                   HdChangeTracker::DirtyComputationPrimvarDesc;
constexpr HdDirtyBits kPrimvarBits = HdChangeTracker::DirtyPrimvar | HdChangeTracker::DirtyNormals |
                                     HdChangeTracker::DirtyWidths | HdChangeTracker::DirtyTopology;

// Primvars that are read under names of their own.
bool is_known(const TfToken& name) {
  return name == HdTokens->points || name == HdTokens->velocities || name == HdTokens->accelerations ||
         name == HdTokens->blurScale || name == HdTokens->nonlinearSampleCount;
}

template <typename Array>
translate::HeldPrimvar held_primvar(const TypedValues<Array>& values) {
  return {held_indices(values.held_indices), values.held};
}

}  // namespace

Shutter shutter_of_rates(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter) {
  constexpr double kInstantFrames = 1.0 / 4096.0;
  if (shutter.moving()) return shutter;
  static const TfToken rates[] = {HdTokens->velocities, TfToken("angularVelocities")};
  const bool any = std::any_of(std::begin(rates), std::end(rates), [&](const TfToken& name) {
    return !timed_primvar(delegate, path, name, shutter, false).at_frame.IsEmpty();
  });
  return any ? Shutter{0.0, kInstantFrames} : shutter;
}

double time_codes_per_second(HdSceneDelegate& delegate) {
  constexpr double kUsual = 24.0;
  static const TfToken globals("sceneGlobals"), rate("timeCodesPerSecond");  // by name: 24.11 has no accessor
  const HdSceneIndexBaseRefPtr scene = delegate.GetRenderIndex().GetTerminalSceneIndex();
  if (!scene) return kUsual;
  const auto source = HdSampledDataSource::Cast(
      scene->GetDataSource(SdfPath::AbsoluteRootPath(), HdDataSourceLocator(globals, rate)));
  const VtValue value = source ? source->GetValue(0.0f) : VtValue();
  const double found = value.IsHolding<double>() ? value.UncheckedGet<double>() : kUsual;
  return found > 0.0 ? found : kUsual;
}

void Shape::set_links(const SdfPath& instancer, const SdfPath& material, bool visible) {
  instancer_ = instancer;
  material_ = material;
  visible_ = visible;
}

void Shape::set_render_tag(const TfToken& tag, RenderParam& param) {
  if (tag == render_tag_) return;
  render_tag_ = tag;
  param.note_render_tag();
}

void Shape::sync(HdSceneDelegate& delegate, HdDirtyBits bits, std::int32_t prim_id) {
  delegate_ = &delegate;
  prim_id_ = prim_id;
  if (HdChangeTracker::IsTopologyDirty(bits, path_) || HdChangeTracker::IsSubdivTagsDirty(bits, path_))
    sync_topology(delegate);
  if (bits & HdChangeTracker::DirtyCategories) {
    categories_.clear();
    for (const TfToken& category : delegate.GetCategories(path_)) categories_.push_back(category.GetString());
  }
  stale_ |= bits;
}

HdDirtyBits Shape::point_bits() const { return kPointBits; }

double Shape::blur_scale(HdSceneDelegate& delegate, const Shutter& shutter) {
  const VtValue value = timed_primvar(delegate, path_, HdTokens->blurScale, shutter, false).at_frame;
  if (value.IsEmpty()) return 1.0;
  const VtValue one = value.IsHolding<VtFloatArray>() && value.GetArraySize() == 1
                          ? VtValue(value.UncheckedGet<VtFloatArray>()[0])
                          : value;
  const VtValue number = VtValue::Cast<double>(one);
  if (number.IsHolding<double>())
    return translate::checked_scale({path_.GetString()}, number.UncheckedGet<double>(), 1.0, said_);
  said_.push_back({translate::Severity::kWarning, path_.GetString(), "motion:blurScale",
                   translate::message("found ", value.GetTypeName(), ", expected a number; took 1")});
  return 1.0;
}

// What is invisible over all of the shutter stays stale, and unread.
void Shape::pull(const Shutter& shutter) {
  if (!delegate_) return;
  shown_ = shutter.moving() ? timed_visibility(*delegate_, path_, shutter) : std::nullopt;
  if (!visible()) return;
  const bool whole = !read_ || !(camera_shutter_ == shutter);
  const auto stale = [&](HdDirtyBits bits) { return whole || (stale_ & bits) != 0; };
  if (!stale(~HdDirtyBits(0))) return;
  said_.clear();
  const Shutter own = shutter_of_rates(*delegate_, path_, shutter.scaled(blur_scale(*delegate_, shutter)));
  const bool same_window = own == shutter_ && !whole;
  shutter_ = own;
  if (stale(HdChangeTracker::DirtyTransform) || !same_window)
    motion_ = transform_motion(*delegate_, path_, shutter_);
  if (stale(point_bits()) || !same_window) pull_points(*delegate_);
  if (stale(kPrimvarBits) || !same_window) pull_primvars(*delegate_);
  camera_shutter_ = shutter;
  read_ = true;
  stale_ = 0;
}

void Shape::pull_points(HdSceneDelegate& delegate) {
  const std::string path = path_.GetString();
  TimedValues found = timed_computation(delegate, path_, HdTokens->points, shutter_);
  computed_points_ = !found.empty();
  if (!computed_points_) found = timed_primvar(delegate, path_, HdTokens->points, shutter_, false);
  points_ = typed<VtVec3fArray>(found, shutter_, path, "points", said_);
  velocities_ = accelerations_ = {};
  if (!computed_points_ && shutter_.moving()) {
    velocities_ = typed<VtVec3fArray>(timed_primvar(delegate, path_, HdTokens->velocities, shutter_, false),
                                      shutter_, path, "velocities", said_);
    accelerations_ =
        typed<VtVec3fArray>(timed_primvar(delegate, path_, HdTokens->accelerations, shutter_, false),
                            shutter_, path, "accelerations", said_);
  }
  time_codes_per_second_ = time_codes_per_second(delegate);
  topology_varies_ = pull_topology(delegate, shutter_);
}

void Shape::pull_primvars(HdSceneDelegate& delegate) {
  display_color_ = normals_ = {};
  display_opacity_ = widths_ = {};
  others_.clear();
  for (const HdInterpolation interpolation : kInterpolations) {
    for (const HdPrimvarDescriptor& each : delegate.GetPrimvarDescriptors(path_, interpolation)) {
      if (!is_known(each.name)) pull_primvar(delegate, each);
    }
  }
}

void Shape::pull_primvar(HdSceneDelegate& delegate, const HdPrimvarDescriptor& descriptor) {
  const std::string path = path_.GetString(), name = descriptor.name.GetString();
  const std::string interpolation = interpolation_name(descriptor.interpolation);
  const auto values = [&] {
    return timed_primvar(delegate, path_, descriptor.name, shutter_, descriptor.indexed);
  };
  if (descriptor.name == HdTokens->displayColor || descriptor.name == HdTokens->normals) {
    auto& primvar = descriptor.name == HdTokens->normals ? normals_ : display_color_;
    primvar = {name, interpolation, typed<VtVec3fArray>(values(), shutter_, path, name, said_)};
  } else if (descriptor.name == HdTokens->displayOpacity || descriptor.name == HdTokens->widths) {
    auto& primvar = descriptor.name == HdTokens->widths ? widths_ : display_opacity_;
    primvar = {name, interpolation, typed<VtFloatArray>(values(), shutter_, path, name, said_)};
    if (descriptor.name == HdTokens->widths) hold_frame(widths_.values, path, name, said_);
  } else {
    Diagnostics unsaid;  // not every primvar is for us
    ShapePrimvar<VtVec3fArray> other{name, interpolation,
                                     typed<VtVec3fArray>(values(), shutter_, path, name, unsaid)};
    hold_frame(other.values, path, "primvars:" + name, unsaid);
    if (other.values.authored()) others_.push_back(std::move(other));
  }
}

translate::FrameShape Shape::frame_shape(Diagnostics& said) const {
  said.insert(said.end(), said_.begin(), said_.end());
  translate::FrameShape shape;
  translate::MeshInput& mesh = shape.mesh;
  mesh.path = path_.GetString();
  mesh.prim_id = prim_id_ < 0 ? kNone : std::uint32_t(prim_id_);
  mesh.visible = shown_;
  mesh.points = array_samples(points_);
  mesh.rates = {array_samples(velocities_), array_samples(accelerations_)};
  mesh.time_remap = translate::rate_times(shutter_, time_codes_per_second_);
  mesh.topology_varies = topology_varies_;
  mesh.computed_points = computed_points_;
  add_primvars(shape);
  shape.motion = motion_;
  shape.material = material_.GetString();
  describe(shape);
  return shape;
}

void Shape::add_primvars(translate::FrameShape& shape) const {
  translate::MeshInput& mesh = shape.mesh;
  // What computes points computes no normals: authored ones are those of the pose at rest.
  if (wants_normals() && !computed_points_ && normals_.values.authored()) {
    mesh.normals = array_samples(normals_.values);
    mesh.normals_interpolation = normals_.interpolation;
    mesh.normals_indices = span_of(normals_.values.indices);
    shape.held.normals_indices = held_indices(normals_.values.held_indices);
  }
  mesh.display_color = primvar_input<Vec3f>(display_color_.values, display_color_.interpolation);
  mesh.display_opacity = primvar_input<float>(display_opacity_.values, display_opacity_.interpolation);
  shape.held.display_color = held_primvar(display_color_.values);
  shape.held.display_opacity = held_primvar(display_opacity_.values);
  for (const ShapePrimvar<VtVec3fArray>& other : others_)
    mesh.named_primvars.push_back({other.name, primvar_input<Vec3f>(other.values, other.interpolation)});
}

}  // namespace msbvh::hydra
