#include "delegate/hydra/renderer_plugin.h"

#include <pxr/imaging/hd/rendererPluginRegistry.h>

#if MSBVH_DECLARES_MOTION
#include <pxr/imaging/hd/renderDelegateInfo.h>
#include <pxr/imaging/hd/retainedDataSource.h>
#include <pxr/imaging/hd/tokens.h>
#if MSBVH_HAS_CREATE_ARGS
#include <pxr/imaging/hd/sceneIndexCreateArgsSchema.h>
#else
#include <pxr/imaging/hd/sceneIndexInputArgsSchema.h>
#endif
#endif

#include "delegate/hydra/delegate.h"

PXR_NAMESPACE_OPEN_SCOPE

TF_REGISTRY_FUNCTION(TfType) { HdRendererPluginRegistry::Define<HdMsbvhRendererPlugin>(); }

HdRenderDelegate* HdMsbvhRendererPlugin::CreateRenderDelegate() { return new msbvh::hydra::Delegate(); }

HdRenderDelegate* HdMsbvhRendererPlugin::CreateRenderDelegate(const HdRenderSettingsMap& settings) {
  return new msbvh::hydra::Delegate(settings);
}

void HdMsbvhRendererPlugin::DeleteRenderDelegate(HdRenderDelegate* delegate) { delete delegate; }

#if MSBVH_SUPPORTED_BY_SCHEMA
bool HdMsbvhRendererPlugin::IsSupported(const HdRendererCreateArgsSchema&, std::string*) const {
  return true;
}
#endif
#if MSBVH_SUPPORTED_BY_ARGS
bool HdMsbvhRendererPlugin::IsSupported(const HdRendererCreateArgs&, std::string*) const { return true; }
#endif
#if MSBVH_SUPPORTED_BY_GPU
bool HdMsbvhRendererPlugin::IsSupported(bool) const { return true; }
#endif

#if MSBVH_DECLARES_MOTION
namespace {

HdRenderDelegateInfo delegate_info() {
  HdRenderDelegateInfo info{};
  info.materialBindingPurpose = HdTokens->full;
  info.renderSettingsNamespaces = {TfToken("msbvh")};
  return info;
}

template <typename Schema>
HdContainerDataSourceHandle motion_wanted() {
  using Flag = HdRetainedTypedSampledDataSource<bool>;
  return typename Schema::Builder()
      .SetMotionBlurSupport(Flag::New(true))
      .SetCameraMotionBlurSupport(Flag::New(true))
      .SetLegacyRenderDelegateInfo(
          HdRetainedTypedSampledDataSource<HdRenderDelegateInfo>::New(delegate_info()))
      .Build();
}

}  // namespace

#if MSBVH_HAS_CREATE_ARGS
HdContainerDataSourceHandle HdMsbvhRendererPlugin::GetSceneIndexCreateArgs() const {
  return motion_wanted<HdSceneIndexCreateArgsSchema>();
}
#else
HdContainerDataSourceHandle HdMsbvhRendererPlugin::GetSceneIndexInputArgs() const {
  return motion_wanted<HdSceneIndexInputArgsSchema>();
}
#endif
#endif

PXR_NAMESPACE_CLOSE_SCOPE
