// Buffers that hosts read pictures from.
#pragma once

#include <cstdint>
#include <mutex>
#include <pxr/base/gf/rect2i.h>
#include <pxr/imaging/hd/renderBuffer.h>
#include <vector>

#include "core/film/image.h"
#include "delegate/hydra/api_version.h"

namespace msbvh::hydra {

// The render thread writes whole pictures; what a host has mapped does not change until it is unmapped.
// Hosts count rows from the lowest one up, pictures from the uppermost down.
class RenderBuffer : public HdRenderBuffer {
 public:
  explicit RenderBuffer(const SdfPath& path) : HdRenderBuffer(path) {}

  void Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) override;
  void Finalize(HdRenderParam* param) override;
  bool Allocate(const GfVec3i& dimensions, HdFormat format, bool multi_sampled) override;
  unsigned int GetWidth() const override { return width_; }
  unsigned int GetHeight() const override { return height_; }
  unsigned int GetDepth() const override { return 1; }
  HdFormat GetFormat() const override { return format_; }
  bool IsMultiSampled() const override { return multi_sampled_; }
  void* Map() override;
  void Unmap() override;
  bool IsMapped() const override;
  void Resolve() override;
  bool IsConverged() const override;

  // `clear_value` everywhere, as the binding has it; not converged.
  void clear(const VtValue& clear_value);
  // A picture of a data window, whose corner is counted from the upper left; what lies outside of the buffer
  // is left out. Values of `channels` numbers, or one id.
  struct Pixels {
    std::uint32_t width = 0, height = 0, channels = 0;
    const float* values = nullptr;
    const std::int32_t* ids = nullptr;
  };
  void write(const Pixels& pixels, const GfRect2i& data_window);
  void set_converged(bool converged);

 private:
  void _Deallocate() override;
  void take_over();  // with the lock

  mutable std::mutex mutex_;
  unsigned int width_ = 0, height_ = 0;
  HdFormat format_ = HdFormatInvalid;
  bool multi_sampled_ = false, converged_ = false, fresh_ = false;
  int mappers_ = 0;
  std::vector<std::uint8_t> shown_, pending_;
};

// Formats that pictures can be written in.
bool is_supported(HdFormat format);

}  // namespace msbvh::hydra
