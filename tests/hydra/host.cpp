#include "tests/hydra/host.h"

#include <algorithm>
#include <chrono>
#include <pxr/base/gf/rect2i.h>
#include <pxr/base/gf/vec4f.h>
#include <pxr/imaging/cameraUtil/framing.h>
#include <pxr/imaging/hd/camera.h>
#include <pxr/imaging/hd/renderBuffer.h>
#include <pxr/imaging/hd/renderPass.h>
#include <pxr/imaging/hd/renderPassState.h>
#include <pxr/imaging/hd/rendererPluginRegistry.h>
#include <pxr/imaging/hd/rprimCollection.h>
#include <pxr/imaging/hd/task.h>
#include <pxr/imaging/hd/tokens.h>
#include <pxr/usdImaging/usdImaging/stageSceneIndex.h>
#include <stdexcept>
#include <thread>
#include <utility>

namespace msbvh::testing {
namespace {

constexpr double kPatienceSeconds = 60.0;
constexpr std::chrono::milliseconds kBetweenExecutions{5};

HdRprimCollection everything() {
  HdRprimCollection collection(HdTokens->geometry, HdReprSelector(HdReprTokens->smoothHull));
  collection.SetRootPath(SdfPath::AbsoluteRootPath());
  return collection;
}

}  // namespace

// One render pass, through one camera.
class Host::Task : public HdTask {
 public:
  Task(HdRenderIndex& index, SdfPath camera, const GfRect2i& window, HdRenderPassAovBindingVector bindings)
      : HdTask(SdfPath("/host/task")),
        camera_(std::move(camera)),
        pass_(index.GetRenderDelegate()->CreateRenderPass(&index, everything())),
        state_(index.GetRenderDelegate()->CreateRenderPassState()) {
    state_->SetAovBindings(bindings);
    state_->SetFraming(CameraUtilFraming(window));
  }

  void Sync(HdSceneDelegate*, HdTaskContext*, HdDirtyBits* bits) override {
    pass_->Sync();
    *bits = HdChangeTracker::Clean;
  }
  void Prepare(HdTaskContext*, HdRenderIndex* index) override {
    state_->SetCamera(static_cast<const HdCamera*>(index->GetSprim(HdPrimTypeTokens->camera, camera_)));
  }
  void Execute(HdTaskContext*) override { pass_->Execute(state_, GetRenderTags()); }
  const TfTokenVector& GetRenderTags() const override {
    static const TfTokenVector tags{HdRenderTagTokens->geometry};
    return tags;
  }
  bool is_converged() const { return pass_->IsConverged(); }

 private:
  SdfPath camera_;
  HdRenderPassSharedPtr pass_;
  HdRenderPassStateSharedPtr state_;
};

Host::Host(const UsdStageRefPtr& stage, Engine engine, const SdfPath& camera, std::uint32_t width,
           std::uint32_t height, const char* renderer)
    : engine_mode_(engine), width_(width), height_(height) {
  HdRendererPluginRegistry& registry = HdRendererPluginRegistry::GetInstance();
  delegate_ =
      std::make_unique<HdPluginRenderDelegateUniqueHandle>(registry.CreateRenderDelegate(TfToken(renderer)));
  if (!*delegate_) throw std::runtime_error(std::string("found no ") + renderer + " in PXR_PLUGINPATH_NAME");
  index_.reset(HdRenderIndex::New(delegate_->Get(), {}));
  if (!index_) throw std::runtime_error("found no render index for the plugin");
  if (engine == Engine::kSceneDelegate) {
    scene_delegate_ = std::make_unique<UsdImagingDelegate>(index_.get(), SdfPath::AbsoluteRootPath());
    scene_delegate_->Populate(stage->GetPseudoRoot());
    scene_delegate_->SetCameraForSampling(camera);  // as UsdImagingGLEngine does
  } else {
    UsdImagingCreateSceneIndicesInfo info;
    info.stage = stage;
    scene_ = UsdImagingCreateSceneIndices(info);
    index_->InsertSceneIndex(scene_.finalSceneIndex, SdfPath::AbsoluteRootPath());
  }
  bindings_.resize(2);
  bindings_[0].aovName = HdAovTokens->color;
  bindings_[0].clearValue = VtValue(GfVec4f(0.0f));
  bindings_[0].renderBuffer = add_buffer(HdAovTokens->color, HdFormatFloat32Vec4, bindings_[0].clearValue);
  bindings_[1].aovName = HdAovTokens->primId;
  bindings_[1].clearValue = VtValue(-1);
  bindings_[1].renderBuffer = add_buffer(HdAovTokens->primId, HdFormatInt32, bindings_[1].clearValue);
  task_ = std::make_shared<Task>(*index_, camera, GfRect2i(GfVec2i(0), int(width), int(height)), bindings_);
}

// As hosts do: the pass, then the buffers, then the scene, then the delegate.
Host::~Host() {
  task_.reset();
  for (const HdRenderPassAovBinding& binding : bindings_) {
    binding.renderBuffer->Finalize(delegate().GetRenderParam());
    delegate().DestroyBprim(binding.renderBuffer);
  }
  scene_delegate_.reset();
  index_.reset();
  scene_ = {};
  delegate_.reset();
}

HdRenderBuffer* Host::add_buffer(const TfToken& aov, HdFormat format, const VtValue&) {
  const SdfPath path = SdfPath("/host").AppendChild(aov);
  auto* buffer = static_cast<HdRenderBuffer*>(delegate().CreateBprim(HdPrimTypeTokens->renderBuffer, path));
  if (!buffer || !buffer->Allocate(GfVec3i(int(width_), int(height_), 1), format, false))
    throw std::runtime_error("found no render buffer for " + aov.GetString());
  return buffer;
}

void Host::set_time(double frame) {
  if (scene_delegate_) scene_delegate_->SetTime(UsdTimeCode(frame));
  if (scene_.stageSceneIndex) scene_.stageSceneIndex->SetTime(UsdTimeCode(frame));
}

void Host::set(const char* setting, const VtValue& value) {
  delegate().SetRenderSetting(TfToken(setting), value);
}

void Host::execute() {
  if (scene_delegate_) scene_delegate_->ApplyPendingUpdates();
  if (scene_.stageSceneIndex) scene_.stageSceneIndex->ApplyPendingUpdates();
  HdTaskSharedPtrVector tasks{task_};
  engine_.Execute(index_.get(), &tasks);
}

bool Host::is_converged() const { return task_->is_converged(); }

bool Host::shows_something() const {
  HdRenderBuffer& color = *bindings_[0].renderBuffer;
  color.Resolve();
  const auto* rgba = static_cast<const float*>(color.Map());
  const bool found =
      rgba && std::any_of(rgba, rgba + 4 * std::size_t(width_) * height_, [](float x) { return x != 0.0f; });
  color.Unmap();
  return found;
}

Host::Waits Host::converge() {
  const auto begin = std::chrono::steady_clock::now();
  const auto since = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  Waits waits;
  execute();
  while (!is_converged()) {
    if (waits.first_picture == 0.0 && shows_something()) waits.first_picture = since();
    if (since() > kPatienceSeconds) throw std::runtime_error("found a render pass that does not converge");
    std::this_thread::sleep_for(kBetweenExecutions);
    execute();
  }
  waits.converged = since();
  if (waits.first_picture == 0.0) waits.first_picture = waits.converged;
  return waits;
}

Picture Host::picture() {
  Picture picture{width_, height_, {}, {}};
  HdRenderBuffer &color = *bindings_[0].renderBuffer, &ids = *bindings_[1].renderBuffer;
  color.Resolve();
  ids.Resolve();
  const auto* rgba = static_cast<const float*>(color.Map());
  const auto* prims = static_cast<const std::int32_t*>(ids.Map());
  for (std::uint32_t row = height_; row-- > 0;) {  // the lowest row is the buffer's first
    const std::size_t first = std::size_t(row) * width_;
    picture.rgba.insert(picture.rgba.end(), rgba + 4 * first, rgba + 4 * (first + width_));
    picture.prim_ids.insert(picture.prim_ids.end(), prims + first, prims + first + width_);
  }
  color.Unmap();
  ids.Unmap();
  return picture;
}

}  // namespace msbvh::testing
