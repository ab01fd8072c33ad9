#include "delegate/hydra/render_param.h"

#include <pxr/imaging/hd/changeTracker.h>

#include "delegate/hydra/light.h"
#include "delegate/hydra/material.h"
#include "delegate/hydra/shape.h"

namespace msbvh::hydra {
namespace {

constexpr HdDirtyBits kTopologyBits = HdChangeTracker::DirtyTopology | HdChangeTracker::DirtySubdivTags |
                                      HdChangeTracker::DirtyInstancer | HdChangeTracker::DirtyInstanceIndex |
                                      HdChangeTracker::DirtyRenderTag;
constexpr HdDirtyBits kLookBits = HdChangeTracker::DirtyPrimvar | HdChangeTracker::DirtyNormals |
                                  HdChangeTracker::DirtyWidths | HdChangeTracker::DirtyMaterialId |
                                  HdChangeTracker::DirtyVisibility | HdChangeTracker::DirtyCategories;

template <typename Prim>
std::vector<Prim*> values_of(const std::map<SdfPath, Prim*>& prims) {
  std::vector<Prim*> result;
  for (const auto& [path, prim] : prims) result.push_back(prim);
  return result;
}

}  // namespace

void RenderParam::note_shape(Shape& shape, HdDirtyBits bits) {
  const std::scoped_lock lock(mutex_);
  const bool is_new = shapes_.emplace(shape.path(), &shape).second;
  edits_.topology += is_new || (bits & kTopologyBits);
  edits_.points +=
      (bits & (HdChangeTracker::DirtyPoints | HdChangeTracker::DirtyComputationPrimvarDesc)) != 0;
  edits_.transforms += (bits & HdChangeTracker::DirtyTransform) != 0;
  edits_.looks += (bits & kLookBits) != 0;
}

void RenderParam::forget_shape(Shape& shape) {
  const std::scoped_lock lock(mutex_);
  edits_.topology += shapes_.erase(shape.path());
}

void RenderParam::note_light(Light& light) {
  const std::scoped_lock lock(mutex_);
  lights_[light.GetId()] = &light;
  ++edits_.lights;
}

void RenderParam::forget_light(Light& light) {
  const std::scoped_lock lock(mutex_);
  edits_.lights += lights_.erase(light.GetId());
}

void RenderParam::note_material(Material& material) {
  const std::scoped_lock lock(mutex_);
  materials_[material.GetId()] = &material;
  ++edits_.looks;
}

void RenderParam::forget_material(Material& material) {
  const std::scoped_lock lock(mutex_);
  edits_.looks += materials_.erase(material.GetId());
}

void RenderParam::note_instancer(HdDirtyBits bits) {
  const std::scoped_lock lock(mutex_);
  edits_.topology += (bits & kTopologyBits) != 0;
  edits_.transforms += (bits & (HdChangeTracker::DirtyTransform | HdChangeTracker::DirtyPrimvar)) != 0;
  edits_.looks += (bits & HdChangeTracker::DirtyVisibility) != 0;
}

void RenderParam::note_settings() {
  const std::scoped_lock lock(mutex_);
  ++edits_.settings;
}

void RenderParam::note_camera() {
  const std::scoped_lock lock(mutex_);
  ++edits_.cameras;
}

void RenderParam::note_render_tag() {
  const std::scoped_lock lock(mutex_);
  ++edits_.topology;
}

void RenderParam::note_buffer() {
  const std::scoped_lock lock(mutex_);
  ++edits_.buffers;
}

Edits RenderParam::edits() const {
  const std::scoped_lock lock(mutex_);
  return edits_;
}

std::vector<Shape*> RenderParam::shapes() const {
  const std::scoped_lock lock(mutex_);
  return values_of(shapes_);
}

std::vector<Light*> RenderParam::lights() const {
  const std::scoped_lock lock(mutex_);
  return values_of(lights_);
}

std::vector<Material*> RenderParam::materials() const {
  const std::scoped_lock lock(mutex_);
  return values_of(materials_);
}

std::optional<Shutter> RenderParam::last_shutter() const {
  const std::scoped_lock lock(mutex_);
  return last_shutter_;
}

void RenderParam::set_last_shutter(const Shutter& shutter) {
  const std::scoped_lock lock(mutex_);
  last_shutter_ = shutter;
}

bool RenderParam::is_news(const std::string& text) {
  const std::scoped_lock lock(mutex_);
  return said_.insert(text).second;
}

}  // namespace msbvh::hydra
