// What meshes, curves and points have in common: their values over the shutter, read again only as far as
// they are stale, and the translator's view of them. Not an HdRprim itself: mesh.h, curves.h and points.h
// hold one.
#pragma once

#include <atomic>
#include <cstdint>
#include <pxr/imaging/hd/changeTracker.h>
#include <pxr/imaging/hd/geomSubset.h>
#include <pxr/imaging/hd/sceneDelegate.h>
#include <string>
#include <vector>

#include "delegate/hydra/typed_values.h"
#include "delegate/translate/frame/frame_input.h"

namespace msbvh::hydra {

class RenderParam;

// A primvar that shading may ask for.
template <typename Array>
struct ShapePrimvar {
  std::string name{};
  std::string interpolation = "constant";
  TypedValues<Array> values{};
};

// What is dirty in the beginning: everything but whether it may change again.
inline constexpr HdDirtyBits kFirstBits =
    HdChangeTracker::AllSceneDirtyBits & ~HdDirtyBits(HdChangeTracker::Varying);

class Shape {
 public:
  explicit Shape(const SdfPath& path) : path_(path) {}
  virtual ~Shape() = default;

  const SdfPath& path() const { return path_; }
  const SdfPath& instancer() const { return instancer_; }
  const SdfPath& material() const { return material_; }
  const TfToken& render_tag() const { return render_tag_; }
  // Whether any of it can be seen: at the frame, or over the shutter where the host says so. After pull().
  bool visible() const { return shown_ ? !shown_->empty() : visible_; }
  // The camera's, scaled by motion:blurScale. After pull().
  const Shutter& own_shutter() const { return shutter_; }
  // Lights' collections that hold it.
  const std::vector<std::string>& categories() const { return categories_; }

  // During Sync: takes over what does not depend on the shutter, and remembers what else is stale. `prim_id`
  // as Hydra counts it.
  void sync(HdSceneDelegate& delegate, HdDirtyBits bits, std::int32_t prim_id);
  void set_links(const SdfPath& instancer, const SdfPath& material, bool visible);
  void set_render_tag(const TfToken& tag, RenderParam& param);
  // Reads what is stale, or was read for another shutter. Shapes may be read side by side.
  void pull(const Shutter& shutter);

  // Borrows this shape, until the next pull(). What it has to say goes to `said`, as after each pull().
  translate::FrameShape frame_shape(Diagnostics& said) const;

 protected:
  virtual void sync_topology(HdSceneDelegate& delegate) = 0;
  // What of the topology changes within the shutter; asked where points or topology are stale. Returns
  // whether points have no path from one topology to the next.
  virtual bool pull_topology(HdSceneDelegate&, const Shutter&) { return false; }
  // What makes points, or what stands for them, stale.
  virtual HdDirtyBits point_bits() const;
  // The topology and all that only this kind has.
  virtual void describe(translate::FrameShape& shape) const = 0;
  virtual bool wants_normals() const { return true; }

  // Diameters of curves and points.
  const ShapePrimvar<VtFloatArray>& widths() const { return widths_; }

 private:
  void add_primvars(translate::FrameShape& shape) const;
  void pull_points(HdSceneDelegate& delegate);
  void pull_primvars(HdSceneDelegate& delegate);
  void pull_primvar(HdSceneDelegate& delegate, const HdPrimvarDescriptor& descriptor);
  double blur_scale(HdSceneDelegate& delegate, const Shutter& shutter);

  SdfPath path_, instancer_, material_;
  TfToken render_tag_;
  HdSceneDelegate* delegate_ = nullptr;
  HdDirtyBits stale_ = 0;
  std::int32_t prim_id_ = -1;
  std::vector<std::string> categories_;
  bool visible_ = true, topology_varies_ = false, computed_points_ = false;
  translate::Visibility shown_;       // by the camera's shutter
  Shutter camera_shutter_, shutter_;  // as read: the camera's, and this prim's own
  bool read_ = false;

  translate::MotionPointer motion_;
  TypedValues<VtVec3fArray> points_, velocities_, accelerations_;
  ShapePrimvar<VtVec3fArray> display_color_, normals_;
  ShapePrimvar<VtFloatArray> display_opacity_, widths_;
  std::vector<ShapePrimvar<VtVec3fArray>> others_;
  double time_codes_per_second_ = 24.0;
  Diagnostics said_;
};

// A closed shutter, opened for an instant where velocities say where things are between their samples.
Shutter shutter_of_rates(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter);

// Of the stage, where the host's scene globals know it; else 24, USD's own.
double time_codes_per_second(HdSceneDelegate& delegate);

}  // namespace msbvh::hydra
