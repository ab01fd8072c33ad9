// What a host loads: makes render delegates.
#pragma once

#include <pxr/imaging/hd/rendererPlugin.h>
#include <string>

#include "delegate/hydra/api_version.h"

PXR_NAMESPACE_OPEN_SCOPE

// In OpenUSD's namespace, since plugInfo.json names the type.
class HdMsbvhRendererPlugin final : public HdRendererPlugin {
 public:
  HdRenderDelegate* CreateRenderDelegate() override;
  HdRenderDelegate* CreateRenderDelegate(const HdRenderSettingsMap& settings) override;
  void DeleteRenderDelegate(HdRenderDelegate* delegate) override;

  // Always: it needs no GPU, and instruction sets are chosen at run time.
#if MSBVH_SUPPORTED_BY_SCHEMA
  bool IsSupported(const HdRendererCreateArgsSchema& args, std::string* why_not) const override;
#endif
#if MSBVH_SUPPORTED_BY_ARGS
  bool IsSupported(const HdRendererCreateArgs& args, std::string* why_not = nullptr) const override;
#endif
#if MSBVH_SUPPORTED_BY_GPU
  bool IsSupported(bool gpu_enabled = true) const override;
#endif

  // That motion of prims and cameras is wanted: scene indices keep times by it.
#if MSBVH_HAS_CREATE_ARGS
  HdContainerDataSourceHandle GetSceneIndexCreateArgs() const override;
#elif MSBVH_DECLARES_MOTION
  HdContainerDataSourceHandle GetSceneIndexInputArgs() const override;
#endif
};

PXR_NAMESPACE_CLOSE_SCOPE
