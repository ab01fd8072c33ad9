// Cameras over their shutter.
#pragma once

#include <optional>
#include <pxr/imaging/cameraUtil/conformWindow.h>
#include <pxr/imaging/cameraUtil/framing.h>
#include <pxr/imaging/hd/camera.h>
#include <pxr/imaging/hd/renderPassState.h>
#include <vector>

#include "delegate/hydra/typed_values.h"
#include "delegate/translate/frame/camera_moments.h"

namespace msbvh::hydra {

class Camera : public HdCamera {
 public:
  explicit Camera(const SdfPath& path) : HdCamera(path) {}

  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) override;
  // Null before the first Sync, as of a fallback prim.
  HdSceneDelegate* delegate() const { return delegate_; }

 private:
  HdSceneDelegate* delegate_ = nullptr;
};

// What an image shows and how many pixels it has.
struct ImageFrame {
  std::uint32_t width = 0, height = 0;  // of the buffers
  GfRect2i data_window{};               // the pixels of them that are rendered
  translate::Framing framing{};

  bool operator==(const ImageFrame&) const = default;
};

// From a render pass' state: the camera's framing, or the viewport of hosts that know no other.
ImageFrame image_frame(const HdRenderPassState& state);

// Closed, with a word, where the camera's times make no sense; and where there is no camera.
Shutter shutter_of(const HdRenderPassState& state, Diagnostics& said);

// What the camera multiplies light by; 1 where there is none, or it makes no sense.
float exposure_of(const HdRenderPassState& state);

// The camera of a render pass over its shutter, or what its matrices say where there is no camera. Throws
// Error where nothing can be seen through it.
translate::CameraInput camera_input(const HdRenderPassState& state, const Shutter& shutter,
                                    const ImageFrame& image, Diagnostics& said);

}  // namespace msbvh::hydra
