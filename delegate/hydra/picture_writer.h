// Pictures into the render buffers that a pass is bound to.
#pragma once

#include <mutex>
#include <pxr/base/gf/rect2i.h>
#include <pxr/imaging/hd/aov.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <string>
#include <vector>

#include "delegate/hydra/render_param.h"
#include "delegate/translate/frame/render_job.h"

namespace msbvh::hydra {

class RenderBuffer;

// Hydra's descriptor of an AOV; an invalid format for one that is not rendered.
HdAovDescriptor aov_descriptor(const TfToken& name);

// Of Hydra's names, as far as they are AOVs beside colour.
std::vector<Aov> aovs_of(const HdRenderPassAovBindingVector& bindings);

class PictureWriter : public translate::PictureSink {
 public:
  explicit PictureWriter(RenderParam& param) : param_(param) {}

  // While nothing renders. Clears the buffers; those of AOVs that there are not stay so, with a warning.
  void bind(const HdRenderPassAovBindingVector& bindings, HdRenderIndex& index, const GfRect2i& data_window);
  void unbind();
  void forget(const RenderBuffer& buffer);
  // Nothing better will come.
  void give_up();

  // On the render thread, which warns of nothing itself (jobs.h).
  void show(const Image& picture, std::uint32_t samples, bool last) override;
  void failed(const std::string& why) override;
  // As a warning of the host, on its thread.
  void tell_failure();

 private:
  struct Target {
    TfToken name;
    RenderBuffer* buffer;
  };

  RenderParam& param_;
  std::mutex mutex_;
  std::vector<Target> targets_;
  std::string failure_;  // that has not been told
  GfRect2i data_window_{};
};

}  // namespace msbvh::hydra
