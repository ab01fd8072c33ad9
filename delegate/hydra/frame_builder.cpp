#include "delegate/hydra/frame_builder.h"

#include <algorithm>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/renderIndex.h>

#include "core/base/parallel.h"
#include "delegate/hydra/light.h"
#include "delegate/hydra/light_links.h"
#include "delegate/hydra/material.h"
#include "delegate/hydra/shape.h"
#include "delegate/translate/frame/kept_origin.h"

namespace msbvh::hydra {
namespace {

using translate::FrameGroup;
using translate::FrameInput;
using translate::Severity;

bool below_any(const SdfPath& path, const SdfPathVector& roots) {
  return std::any_of(roots.begin(), roots.end(), [&](const SdfPath& root) { return path.HasPrefix(root); });
}

}  // namespace

void tell(const Diagnostics& diagnostics, RenderParam& param) {
  for (const translate::Diagnostic& each : diagnostics) {
    if (each.severity == Severity::kNote) continue;
    const std::string dot = each.path.empty() || each.attribute.empty() ? "" : ".";
    const std::string subject = each.path + dot + each.attribute;
    const std::string what =
        each.message + (each.severity == Severity::kError ? "; the prim is not drawn" : "");
    // A warning that many prims share is given once, for the first prim.
    if (!param.is_news(each.in_common ? each.attribute + what : subject + what)) continue;
    TF_WARN("%s%s%s", subject.c_str(), subject.empty() ? "" : ": ", what.c_str());
  }
}

std::vector<Shape*> FrameBuilder::wanted_shapes(const PassView& view) const {
  std::vector<Shape*> drawn;
  const HdRprimCollection& collection = view.collection;
  for (Shape* shape : param_.shapes()) {
    const TfTokenVector& tags = view.render_tags;
    const bool tagged =
        tags.empty() || std::find(tags.begin(), tags.end(), shape->render_tag()) != tags.end();
    const bool collected = below_any(shape->path(), collection.GetRootPaths()) &&
                           !below_any(shape->path(), collection.GetExcludePaths());
    if (tagged && collected) drawn.push_back(shape);
  }
  return drawn;
}

void FrameBuilder::add_instanced(const Shape& shape, HdRenderIndex& index, const Shutter& shutter,
                                 FrameInput& frame) {
  auto* instancer = static_cast<Instancer*>(index.GetInstancer(shape.instancer()));
  if (!instancer) return;
  Placed placed = instancer->place(shape.path(), {shutter, shape.own_shutter()}, said_);
  if (!placed.visible || placed.count() == 0) return;
  const auto same = std::find_if(known_.begin(), known_.end(), [&](const Known& each) {
    return each.instancer == shape.instancer() && each.indices == placed.indices &&
           each.shutter == shape.own_shutter();
  });
  if (same != known_.end()) {
    frame.groups[same->group].shapes.push_back(shape.frame_shape(said_));
    return;
  }
  known_.push_back({shape.instancer(), placed.indices, shape.own_shutter(), frame.groups.size()});
  FrameGroup& group = frame.groups.emplace_back();
  group.path = shape.instancer().GetString();
  group.shapes.push_back(shape.frame_shape(said_));
  group.levels = std::move(placed.levels);
  group.visible = placed.shown;
  colors_.push_back(std::move(placed.colors));
  group.display_color.values = colors_.back();
  for (auto& [time01, colors] : placed.color_samples) {
    colors_.push_back(std::move(colors));
    group.display_color.samples.push_back({time01, colors_.back()});
  }
}

void FrameBuilder::add_shapes(const std::vector<Shape*>& shapes, HdRenderIndex& index, const Shutter& shutter,
                              FrameInput& frame) {
  parallel_for_ranges(shapes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) shapes[i]->pull(shutter);
  });
  known_.clear();
  colors_.clear();
  frame.groups.emplace_back();  // the world
  LightLinks links(param_.lights());
  for (Shape* shape : shapes) {
    if (!shape->visible()) continue;
    links.add(*shape, frame);
    if (shape->instancer().IsEmpty()) {
      frame.groups.front().shapes.push_back(shape->frame_shape(said_));
    } else {
      add_instanced(*shape, index, shutter, frame);
    }
  }
  add_lights(links, shutter, frame);
}

void FrameBuilder::add_lights(const LightLinks& links, const Shutter& shutter, FrameInput& frame) {
  frame.camera_light = false;  // that is the host's to say
  for (Light* light : param_.lights()) {
    bool at_camera = false;
    std::optional<translate::FrameLight> found = light->frame_light(shutter, textures_, at_camera, said_);
    if (found) {
      links.link(*light, found->look);
      frame.lights.push_back(std::move(*found));
    }
    frame.camera_light = frame.camera_light || at_camera;
  }
}

translate::AssembledFrame FrameBuilder::build(const PassView& view, const ImageFrame& image,
                                              const Shutter& shutter, const Settings& settings) {
  said_.clear();
  FrameInput frame;
  frame.shutter = shutter;
  frame.camera = camera_input(view.state, shutter, image, said_);
  if (!settings.depth_of_field) {
    for (translate::CameraSample& sample : frame.camera.samples) sample.lens = {};
  }
  for (Material* material : param_.materials()) {
    if (!material->network().nodes.empty())
      frame.materials.push_back({material->GetId().GetString(), material->network()});
  }
  add_shapes(wanted_shapes(view), view.index, shutter, frame);
  translate::TranslatorSettings how = settings.translate;
  how.origin = translate::kept_origin(origin_, frame.camera, how.width, how.height);
  translate::AssembledFrame assembled = translate::assemble_frame(frame, how, textures_, refinements_);
  origin_ = assembled.origin;
  assembled.diagnostics.insert(assembled.diagnostics.begin(), said_.begin(), said_.end());
  return assembled;
}

}  // namespace msbvh::hydra
