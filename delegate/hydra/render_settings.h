// Render settings prims: what the active one says about the picture that a host's render pass asks for.
//
// As in hdPrman, the prim's opinions are stronger than the host's SetRenderSetting(), and that is stronger
// than our defaults. Camera, size, framing, AOVs, purposes and files are the render pass': products are
// written by nobody here, and each is named once.
#pragma once

#include <optional>
#include <pxr/imaging/hd/renderSettings.h>

#include "delegate/hydra/render_param.h"
#include "delegate/hydra/settings.h"
#include "delegate/hydra/typed_values.h"
#include "delegate/translate/render/render_spec.h"

namespace msbvh::hydra {

class SettingsPrim : public HdRenderSettings {
 public:
  explicit SettingsPrim(const SdfPath& path) : HdRenderSettings(path) {}

 protected:
  void _Sync(HdSceneDelegate* delegate, HdRenderParam* param, const HdDirtyBits* bits) override;
};

// The one that the host has made active: by the scene's globals where there is a scene index. Null where
// there is none.
const SettingsPrim* active_settings(HdRenderIndex& index);

// What it means for a picture through `camera`; what cannot be honoured is said.
struct PassSettings {
  bool motion_blur = true, depth_of_field = true;
  translate::OwnSettings own{};
};
PassSettings pass_settings(const SettingsPrim& prim, const SdfPath& camera, Diagnostics& said);

// In place of what the host has set.
void apply(const PassSettings& wanted, Settings& settings);

}  // namespace msbvh::hydra
