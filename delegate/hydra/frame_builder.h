// The prims of a render index to one frame's Scene. On the host's thread, between Sync and the next edit.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <pxr/imaging/hd/renderPassState.h>
#include <pxr/imaging/hd/rprimCollection.h>
#include <vector>

#include "core/geometry/subdivision/refinement_cache.h"
#include "delegate/hydra/camera.h"
#include "delegate/hydra/instancer.h"
#include "delegate/hydra/render_param.h"
#include "delegate/hydra/settings.h"
#include "delegate/hydra/textures.h"
#include "delegate/translate/frame/assemble.h"

namespace msbvh::hydra {

class LightLinks;
class Shape;

// What a render pass draws.
struct PassView {
  const HdRenderPassState& state;
  const HdRprimCollection& collection;
  const TfTokenVector& render_tags;
  HdRenderIndex& index;
};

class FrameBuilder {
 public:
  explicit FrameBuilder(RenderParam& param) : param_(param) {}

  // Throws Error for a camera or settings that make no picture.
  translate::AssembledFrame build(const PassView& view, const ImageFrame& image, const Shutter& shutter,
                                  const Settings& settings);

 private:
  // By collection and render tags, hidden ones included.
  std::vector<Shape*> wanted_shapes(const PassView& view) const;
  void add_shapes(const std::vector<Shape*>& shapes, HdRenderIndex& index, const Shutter& shutter,
                  translate::FrameInput& frame);
  void add_instanced(const Shape& shape, HdRenderIndex& index, const Shutter& shutter,
                     translate::FrameInput& frame);
  void add_lights(const LightLinks& links, const Shutter& shutter, translate::FrameInput& frame);

  // Groups of one instancer that so far are there, by what places them.
  struct Known {
    SdfPath instancer;
    std::vector<VtIntArray> indices;
    Shutter shutter;
    std::size_t group;
  };

  RenderParam& param_;
  Textures textures_;
  std::shared_ptr<RefinementCache> refinements_ = std::make_shared<RefinementCache>();
  std::optional<Vec3d> origin_;  // of the last frame's world
  std::vector<Known> known_;
  std::deque<std::vector<Vec3f>> colors_;  // that the frame borrows
  Diagnostics said_;
};

// As warnings of the host, each once.
void tell(const Diagnostics& diagnostics, RenderParam& param);

}  // namespace msbvh::hydra
