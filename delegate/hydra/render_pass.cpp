#include "delegate/hydra/render_pass.h"

#include <algorithm>
#include <exception>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/renderIndex.h>

#include "core/base/error.h"
#include "delegate/hydra/delegate.h"

namespace msbvh::hydra {

bool RenderPass::Seen::operator==(const Seen& other) const {
  return any == other.any && edits == other.edits && settings_version == other.settings_version &&
         image == other.image && shutter == other.shutter && camera == other.camera && view == other.view &&
         projection == other.projection && render_tags == other.render_tags && bindings == other.bindings;
}

RenderPass::~RenderPass() {
  delegate_.job().stop();
  delegate_.writer().unbind();
}

bool RenderPass::IsConverged() const {
  const translate::JobStatus status = delegate_.job().status();
  return seen_.any && status.converged;
}

RenderPass::Seen RenderPass::seen(const HdRenderPassState& state, const TfTokenVector& render_tags) const {
  Seen now;
  Diagnostics unsaid;  // render() says it
  now.any = true;
  now.edits = delegate_.param().edits();
  now.settings_version = delegate_.GetRenderSettingsVersion();
  now.image = image_frame(state);
  now.shutter = shutter_of(state, unsaid);
  if (state.GetCamera()) {
    now.camera = state.GetCamera()->GetId();
  } else {
    now.view = state.GetWorldToViewMatrix();
    now.projection = state.GetProjectionMatrix();
  }
  now.render_tags = render_tags;
  now.bindings = state.GetAovBindings();
  return now;
}

void RenderPass::_Execute(const HdRenderPassStateSharedPtr& state, const TfTokenVector& render_tags) {
  const Seen now = seen(*state, render_tags);
  if (now == seen_) return;  // the render thread goes on
  seen_ = now;
  delegate_.job().stop();
  const GfRect2i& window = now.image.data_window;
  if (now.bindings.empty() && delegate_.param().is_news("no AOVs"))
    TF_WARN("the render pass has no AOV bindings; expected color at least: nothing is rendered");
  if (now.bindings.empty() || window.GetWidth() <= 0 || window.GetHeight() <= 0) {
    delegate_.job().give_up();
    return;
  }
  delegate_.writer().bind(now.bindings, *GetRenderIndex(), now.image.data_window);
  try {
    render(*state);
  } catch (const std::exception& error) {  // a camera that sees nothing, or no memory: never the host's end
    delegate_.writer().failed(error.what());
    delegate_.job().give_up();
  }
}

void RenderPass::render(const HdRenderPassState& state) {
  RenderParam& param = delegate_.param();
  Diagnostics said;
  const Shutter shutter = shutter_of(state, said);
  Settings settings = settings_of(delegate_, said);
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
  delegate_.count_scene();
  delegate_.job().start(std::move(frame.scene), settings.render);
}

}  // namespace msbvh::hydra
