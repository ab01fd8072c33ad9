#include "delegate/hydra/render_pass.h"

#include <algorithm>
#include <exception>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/renderIndex.h>

#include "core/base/error.h"
#include "delegate/hydra/delegate.h"
#include "delegate/hydra/settings.h"

namespace msbvh::hydra {

bool RenderPass::Seen::operator==(const Seen& other) const {
  return any == other.any && edits == other.edits && settings == other.settings && image == other.image &&
         shutter == other.shutter && camera == other.camera && settings_prim == other.settings_prim &&
         view == other.view && clipping_planes == other.clipping_planes && projection == other.projection &&
         render_tags == other.render_tags && bindings == other.bindings;
}

RenderPass::RenderPass(HdRenderIndex* index, const HdRprimCollection& collection, Delegate& delegate)
    : HdRenderPass(index, collection),
      delegate_(delegate),
      jobs_(delegate.param().jobs()),
      own_(delegate.param()) {
  jobs_->add(own_);
}

// The delegate may be gone.
RenderPass::~RenderPass() {
  jobs_->remove(own_);
  own_.job.stop();
}

bool RenderPass::IsConverged() const {
  const bool converged = seen_.any && own_.job.status().converged;
  jobs_->tell_failures();
  return converged;
}

RenderPass::Seen RenderPass::seen(const HdRenderPassState& state, const TfTokenVector& render_tags) const {
  Seen now;
  Diagnostics unsaid;  // render() says it
  now.any = true;
  now.edits = delegate_.param().edits();
  now.settings = values_set(delegate_);
  now.image = image_frame(state);
  now.shutter = shutter_of(state, unsaid);
  if (state.GetCamera()) {
    now.camera = state.GetCamera()->GetId();
  } else {
    now.view = state.GetWorldToViewMatrix();
    now.projection = state.GetProjectionMatrix();
  }
  if (const SettingsPrim* prim = active_settings(*GetRenderIndex())) now.settings_prim = prim->GetId();
  now.clipping_planes = state.GetClipPlanes();
  now.render_tags = render_tags;
  now.bindings = state.GetAovBindings();
  return now;
}

void RenderPass::_Execute(const HdRenderPassStateSharedPtr& state, const TfTokenVector& render_tags) {
  const Seen now = seen(*state, render_tags);
  jobs_->tell_failures();
  if (now == seen_) return;  // the render thread goes on
  seen_ = now;
  own_.job.stop();
  const GfRect2i& window = now.image.data_window;
  if (now.bindings.empty() && delegate_.param().is_news("no AOVs"))
    TF_WARN("the render pass has no AOV bindings; expected color at least: nothing is rendered");
  if (now.bindings.empty() || window.GetWidth() <= 0 || window.GetHeight() <= 0) {
    own_.job.give_up();
    return;
  }
  own_.writer.bind(now.bindings, *GetRenderIndex(), now.image.data_window);
  try {
    render(*state);
  } catch (const std::exception& error) {  // a camera that sees nothing, or no memory: never the host's end
    own_.writer.failed(error.what());
    own_.writer.tell_failure();
    own_.job.give_up();
  }
}

std::optional<PassSettings> RenderPass::prim_settings(Diagnostics& said) const {
  const SettingsPrim* prim = active_settings(*GetRenderIndex());
  return prim ? std::optional(pass_settings(*prim, seen_.camera, said)) : std::nullopt;
}

void RenderPass::render(const HdRenderPassState& state) {
  RenderParam& param = delegate_.param();
  Diagnostics said;
  Shutter shutter = shutter_of(state, said);
  Settings settings = settings_of(delegate_, said);
  if (const std::optional<PassSettings> wanted = prim_settings(said)) {
    apply(*wanted, settings);
    if (!wanted->motion_blur) shutter = {};
  }
  tell(said, param);
  param.set_last_shutter(shutter);
  settings.render.width = std::uint32_t(seen_.image.data_window.GetWidth());
  settings.render.height = std::uint32_t(seen_.image.data_window.GetHeight());
  settings.render.aovs = aovs_of(seen_.bindings);
  settings.translate.width = settings.render.width;
  settings.translate.height = settings.render.height;
  const auto& aovs = settings.render.aovs;
  settings.translate.keep_faces = std::find(aovs.begin(), aovs.end(), Aov::kElementId) != aovs.end();
  const PassView view{state, GetRprimCollection(), seen_.render_tags, *GetRenderIndex()};
  translate::AssembledFrame frame = delegate_.builder().build(view, seen_.image, shutter, settings);
  tell(frame.diagnostics, param);
  settings.render.film.origin = frame.origin;
  settings.render.film.exposure = exposure_of(state);
  settings.render.film.frame_time = {float(shutter.time01(0.0)), float(shutter.frames())};
  delegate_.count_scene();
  jobs_->set_current(own_);
  own_.job.start(std::move(frame.scene), settings.render);
}

}  // namespace msbvh::hydra
