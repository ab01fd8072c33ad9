#include "delegate/hydra/render_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <pxr/base/gf/half.h>
#include <pxr/base/gf/vec2f.h>
#include <pxr/base/gf/vec3f.h>
#include <pxr/base/gf/vec4f.h>

#include "delegate/hydra/jobs.h"
#include "delegate/hydra/render_param.h"

namespace msbvh::hydra {
namespace {

template <typename T>
void put(std::uint8_t* to, std::size_t component, T value) {
  std::memcpy(to + component * sizeof(T), &value, sizeof(T));
}

double clamped(double value, double least, double most) {
  return std::isnan(value) ? least : std::clamp(value, least, most);
}

// One component in the type of a format.
void store(std::uint8_t* to, std::size_t component, HdFormat type, double value) {
  switch (type) {
    case HdFormatUNorm8:
      return put(to, component, std::uint8_t(std::lround(clamped(value, 0.0, 1.0) * 255.0)));
    case HdFormatSNorm8:
      return put(to, component, std::int8_t(std::lround(clamped(value, -1.0, 1.0) * 127.0)));
    case HdFormatFloat16:
      return put(to, component, GfHalf(float(value)));
    case HdFormatFloat32:
      return put(to, component, float(value));
    case HdFormatInt16:
      return put(to, component, std::int16_t(clamped(value, -32768.0, 32767.0)));
    case HdFormatUInt16:
      return put(to, component, std::uint16_t(clamped(value, 0.0, 65535.0)));
    case HdFormatInt32:
      return put(to, component, std::int32_t(clamped(value, -2147483648.0, 2147483647.0)));
    default:
      return;
  }
}

// What a pixel has too few components for: alpha is 1, the rest 0.
double missing(std::size_t component) { return component == 3 ? 1.0 : 0.0; }

std::vector<double> components(const VtValue& value) {
  std::vector<double> result;
  const auto add = [&](const auto& vector, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) result.push_back(double(vector[i]));
  };
  if (value.IsHolding<float>()) result = {double(value.UncheckedGet<float>())};
  if (value.IsHolding<double>()) result = {value.UncheckedGet<double>()};
  if (value.IsHolding<int>()) result = {double(value.UncheckedGet<int>())};
  if (value.IsHolding<GfVec2f>()) add(value.UncheckedGet<GfVec2f>(), 2);
  if (value.IsHolding<GfVec3f>()) add(value.UncheckedGet<GfVec3f>(), 3);
  if (value.IsHolding<GfVec4f>()) add(value.UncheckedGet<GfVec4f>(), 4);
  return result;
}

}  // namespace

bool is_supported(HdFormat format) {
  return format != HdFormatInvalid && format != HdFormatFloat32UInt8 && HdDataSizeOfFormat(format) > 0;
}

void RenderBuffer::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) {
  if (*bits & DirtyDescription) {
    auto& shared = *static_cast<RenderParam*>(param);
    shared.jobs()->forget(*this);
    shared.note_buffer();
  }
  HdRenderBuffer::Sync(delegate, param, bits);
}

void RenderBuffer::Finalize(HdRenderParam* param) {
  static_cast<RenderParam*>(param)->jobs()->forget(*this);
  HdRenderBuffer::Finalize(param);
}

bool RenderBuffer::Allocate(const GfVec3i& dimensions, HdFormat format, bool multi_sampled) {
  const std::scoped_lock lock(mutex_);
  if (dimensions[0] < 0 || dimensions[1] < 0 || dimensions[2] > 1 || !is_supported(format)) {
    TF_WARN(
        "%s: found a render buffer of %d x %d x %d in format %d; expected two dimensions in a format of "
        "up to four numbers",
        GetId().GetText(), dimensions[0], dimensions[1], dimensions[2], int(format));
    return false;
  }
  width_ = unsigned(dimensions[0]);
  height_ = unsigned(dimensions[1]);
  format_ = format;
  multi_sampled_ = multi_sampled;
  shown_.assign(std::size_t(width_) * height_ * HdDataSizeOfFormat(format), 0);
  pending_ = shown_;
  fresh_ = converged_ = false;
  return true;
}

void RenderBuffer::_Deallocate() {
  const std::scoped_lock lock(mutex_);
  width_ = height_ = 0;
  format_ = HdFormatInvalid;
  shown_.clear();
  pending_.clear();
  fresh_ = converged_ = false;
}

void* RenderBuffer::Map() {
  const std::scoped_lock lock(mutex_);
  take_over();
  ++mappers_;
  return shown_.data();
}

void RenderBuffer::Unmap() {
  const std::scoped_lock lock(mutex_);
  --mappers_;
  take_over();
}

bool RenderBuffer::IsMapped() const {
  const std::scoped_lock lock(mutex_);
  return mappers_ > 0;
}

void RenderBuffer::Resolve() {
  const std::scoped_lock lock(mutex_);
  take_over();
}

bool RenderBuffer::IsConverged() const {
  const std::scoped_lock lock(mutex_);
  return converged_;
}

void RenderBuffer::set_converged(bool converged) {
  const std::scoped_lock lock(mutex_);
  converged_ = converged;
}

void RenderBuffer::take_over() {
  if (!fresh_ || mappers_ > 0) return;
  shown_ = pending_;
  fresh_ = false;
}

void RenderBuffer::clear(const VtValue& clear_value) {
  const std::scoped_lock lock(mutex_);
  if (format_ == HdFormatInvalid) return;
  const std::vector<double> value = components(clear_value);
  const std::size_t count = HdGetComponentCount(format_), size = HdDataSizeOfFormat(format_);
  for (std::size_t pixel = 0; pixel < std::size_t(width_) * height_; ++pixel) {
    for (std::size_t i = 0; i < count; ++i) {
      store(&pending_[pixel * size], i, HdGetComponentFormat(format_),
            i < value.size() ? value[i]
            : value.empty()  ? 0.0
                             : missing(i));
    }
  }
  fresh_ = true;
  converged_ = false;
}

void RenderBuffer::write(const Pixels& pixels, const GfRect2i& data_window) {
  const std::scoped_lock lock(mutex_);
  if (format_ == HdFormatInvalid) return;
  const std::size_t count = HdGetComponentCount(format_), size = HdDataSizeOfFormat(format_);
  const HdFormat type = HdGetComponentFormat(format_);
  for (std::uint32_t row = 0; row < pixels.height; ++row) {
    const int y = int(height_) - 1 - (data_window.GetMinY() + int(row));
    if (y < 0 || y >= int(height_)) continue;
    for (std::uint32_t column = 0; column < pixels.width; ++column) {
      const int x = data_window.GetMinX() + int(column);
      if (x < 0 || x >= int(width_)) continue;
      const std::size_t from = std::size_t(row) * pixels.width + column;
      std::uint8_t* to = &pending_[(std::size_t(y) * width_ + std::size_t(x)) * size];
      for (std::size_t i = 0; i < count; ++i) {
        const double value = i >= pixels.channels ? missing(i)
                             : pixels.ids         ? double(pixels.ids[from])
                                                  : double(pixels.values[from * pixels.channels + i]);
        store(to, i, type, value);
      }
    }
  }
  fresh_ = true;
  take_over();
}

}  // namespace msbvh::hydra
