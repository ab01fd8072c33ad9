// A host of the plugin, as small as one can be: a stage through OpenUSD's own scene delegate or scene
// indices, one render pass, buffers that are read back. No GL, no task controller.
#pragma once

#include <cstdint>
#include <memory>
#include <pxr/base/vt/dictionary.h>
#include <pxr/base/vt/value.h>
#include <pxr/imaging/hd/aov.h>
#include <pxr/imaging/hd/engine.h>
#include <pxr/imaging/hd/pluginRenderDelegateUniqueHandle.h>
#include <pxr/imaging/hd/renderIndex.h>
#include <pxr/usd/sdf/path.h>
#include <pxr/usd/usd/stage.h>
#include <pxr/usdImaging/usdImaging/delegate.h>
#include <pxr/usdImaging/usdImaging/sceneIndices.h>
#include <string>
#include <vector>

namespace msbvh::testing {

PXR_NAMESPACE_USING_DIRECTIVE

// Which of OpenUSD's two ways a stage comes to the delegate.
enum class Engine { kSceneDelegate, kSceneIndices };

// Top row first.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgba;
  std::vector<std::int32_t> prim_ids;
};

class Host {
 public:
  // Renders through the camera at `camera`. Throws std::runtime_error where the plugin cannot be loaded: it
  // must be in PXR_PLUGINPATH_NAME.
  Host(const UsdStageRefPtr& stage, Engine engine, const SdfPath& camera, std::uint32_t width,
       std::uint32_t height, const char* renderer = "HdMsbvhRendererPlugin");
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  void set_time(double frame);
  void set(const char* setting, const VtValue& value);
  // Takes over edits of the stage, and has the pass executed once.
  void execute();
  // Executes until the pass has converged. Throws std::runtime_error after a minute. Returns when the colour
  // was not that of the clear value first, and when it had converged, in seconds; the first is looked for at
  // each execution.
  struct Waits {
    double first_picture = 0.0, converged = 0.0;
  };
  Waits converge();
  bool is_converged() const;
  // What the buffers show.
  Picture picture();

  // What the render index has of the stage.
  HdSceneIndexBaseRefPtr scene() const { return index_->GetTerminalSceneIndex(); }
  HdRenderDelegate& delegate() { return **delegate_; }
  VtDictionary stats() const { return (*delegate_)->GetRenderStats(); }

 private:
  class Task;

  bool shows_something() const;
  HdRenderBuffer* add_buffer(const TfToken& aov, HdFormat format, const VtValue& clear);

  Engine engine_mode_;
  std::uint32_t width_, height_;
  std::unique_ptr<HdPluginRenderDelegateUniqueHandle> delegate_;
  std::unique_ptr<HdRenderIndex> index_;
  std::unique_ptr<UsdImagingDelegate> scene_delegate_;
  UsdImagingSceneIndices scene_;
  HdRenderPassAovBindingVector bindings_;
  std::shared_ptr<Task> task_;
  HdEngine engine_;
};

}  // namespace msbvh::testing
