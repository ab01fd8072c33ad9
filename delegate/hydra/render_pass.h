// A render pass: makes the Scene anew where something has been edited, and has it rendered in the background,
// by a thread of its own.
#pragma once

#include <memory>
#include <optional>
#include <pxr/base/gf/vec4d.h>
#include <pxr/base/vt/value.h>
#include <pxr/imaging/hd/renderPass.h>
#include <vector>

#include "delegate/hydra/camera.h"
#include "delegate/hydra/jobs.h"
#include "delegate/hydra/render_param.h"
#include "delegate/hydra/render_settings.h"

namespace msbvh::hydra {

class Delegate;

class RenderPass : public HdRenderPass {
 public:
  RenderPass(HdRenderIndex* index, const HdRprimCollection& collection, Delegate& delegate);
  ~RenderPass() override;

  bool IsConverged() const override;

 protected:
  void _Execute(const HdRenderPassStateSharedPtr& state, const TfTokenVector& render_tags) override;
  void _MarkCollectionDirty() override { seen_ = {}; }

 private:
  // All that a picture is made of.
  struct Seen {
    bool any = false;
    Edits edits;
    std::vector<VtValue> settings;
    ImageFrame image;
    Shutter shutter;
    SdfPath camera;
    SdfPath settings_prim;                  // the active one
    GfMatrix4d view{1.0}, projection{1.0};  // of hosts that set no camera
    std::vector<GfVec4d> clipping_planes;
    TfTokenVector render_tags;
    HdRenderPassAovBindingVector bindings;

    bool operator==(const Seen& other) const;
  };

  Seen seen(const HdRenderPassState& state, const TfTokenVector& render_tags) const;
  void render(const HdRenderPassState& state);
  // What the active render settings prim says; nothing where there is none.
  std::optional<PassSettings> prim_settings(Diagnostics& said) const;

  Delegate& delegate_;
  std::shared_ptr<Jobs> jobs_;
  Seen seen_;
  PassJob own_;
};

}  // namespace msbvh::hydra
