// Lights over their shutter.
#pragma once

#include <optional>
#include <pxr/imaging/hd/light.h>
#include <string>

#include "delegate/hydra/motion_source.h"
#include "delegate/hydra/textures.h"
#include "delegate/hydra/typed_values.h"
#include "delegate/translate/frame/frame_input.h"

namespace msbvh::hydra {

class RenderParam;

class Light : public HdLight {
 public:
  Light(const TfToken& type, const SdfPath& path) : HdLight(path), type_(type) {}

  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) override;
  void Finalize(HdRenderParam* param) override;
  HdDirtyBits GetInitialDirtyBitsMask() const override { return HdLight::AllDirty; }

  // The prim types that become lights.
  static const TfTokenVector& types();

  // None where it is invisible, or of a type that is not supported, which is said. Sets `is_camera_light` in
  // place of it for the light that hosts put at the camera.
  std::optional<translate::FrameLight> frame_light(const Shutter& shutter, const Textures& textures,
                                                   bool& is_camera_light, Diagnostics& said);
  // The category of what it illuminates (lightLink), or what shadows it (shadowLink); empty: everything.
  std::string link(const TfToken& name) const;

 private:
  bool is_hosts_own() const;
  translate::LightSamples samples_at(std::span<const double> times01, std::span<const double> read_at01,
                                     const Shutter& shutter, Diagnostics& said) const;
  translate::SampledLight sampled(const Shutter& shutter, Diagnostics& said) const;
  MotionPointer motion(const Shutter& shutter, Diagnostics& said);
  VtValue parameter(const TfToken& name, float offset) const;
  double number(const TfToken& name, float offset, double fallback, Diagnostics& said) const;

  TfToken type_;
  HdSceneDelegate* delegate_ = nullptr;
  bool visible_ = true;
};

}  // namespace msbvh::hydra
