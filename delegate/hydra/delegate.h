// The render delegate: which prims there are, who renders them, what a host may ask and set.
#pragma once

#include <atomic>
#include <memory>
#include <pxr/imaging/hd/renderDelegate.h>
#include <pxr/imaging/hd/resourceRegistry.h>

#include "delegate/hydra/frame_builder.h"
#include "delegate/hydra/jobs.h"
#include "delegate/hydra/render_param.h"
#include "delegate/hydra/unsupported.h"

namespace msbvh::hydra {

// No state is shared between delegates: several may live in one process.
class Delegate : public HdRenderDelegate {
 public:
  explicit Delegate(const HdRenderSettingsMap& settings = {});
  ~Delegate() override;

  RenderParam& param() { return param_; }
  FrameBuilder& builder() { return builder_; }
  void count_scene() { ++scenes_; }

  const TfTokenVector& GetSupportedRprimTypes() const override;
  const TfTokenVector& GetSupportedSprimTypes() const override;
  const TfTokenVector& GetSupportedBprimTypes() const override;
  HdRenderParam* GetRenderParam() const override { return &param_; }
  HdResourceRegistrySharedPtr GetResourceRegistry() const override { return registry_; }
  HdRenderSettingDescriptorList GetRenderSettingDescriptors() const override;
  VtDictionary GetRenderStats() const override;

  bool IsPauseSupported() const override { return true; }
  bool IsPaused() const override { return jobs_->paused(); }
  bool Pause() override;
  bool Resume() override;
  bool IsStopSupported() const override { return true; }
  bool IsStopped() const override;
  bool Stop(bool blocking) override;
  bool Restart() override;

  HdRenderPassSharedPtr CreateRenderPass(HdRenderIndex* index, const HdRprimCollection& collection) override;
  HdInstancer* CreateInstancer(HdSceneDelegate* delegate, const SdfPath& path) override;
  void DestroyInstancer(HdInstancer* instancer) override;
  HdRprim* CreateRprim(const TfToken& type, const SdfPath& path) override;
  void DestroyRprim(HdRprim* prim) override;
  HdSprim* CreateSprim(const TfToken& type, const SdfPath& path) override;
  HdSprim* CreateFallbackSprim(const TfToken& type) override;
  void DestroySprim(HdSprim* prim) override;
  HdBprim* CreateBprim(const TfToken& type, const SdfPath& path) override;
  HdBprim* CreateFallbackBprim(const TfToken& type) override;
  void DestroyBprim(HdBprim* prim) override;
  void CommitResources(HdChangeTracker*) override {}

  void SetTerminalSceneIndex(const HdSceneIndexBaseRefPtr& scene) override;

  TfToken GetMaterialBindingPurpose() const override;
  TfTokenVector GetRenderSettingsNamespaces() const override;
  HdAovDescriptor GetDefaultAovDescriptor(const TfToken& name) const override;

 private:
  std::shared_ptr<Jobs> jobs_ = std::make_shared<Jobs>();
  mutable RenderParam param_{jobs_};
  HdResourceRegistrySharedPtr registry_ = std::make_shared<HdResourceRegistry>();
  FrameBuilder builder_{param_};
  UnsupportedPrims unsupported_;
  std::atomic<std::uint64_t> scenes_{0};
};

}  // namespace msbvh::hydra
