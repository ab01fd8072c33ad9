// An array that is not initialised: pages that nothing touches cost nothing, and nothing is written twice.
#pragma once

#include <type_traits>

#include "core/base/aligned_buffer.h"

namespace msbvh {

template <typename T>
class RawArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  RawArray() = default;
  explicit RawArray(std::size_t size) : buffer_(size * sizeof(T)), size_(size) {}

  T* data() { return reinterpret_cast<T*>(buffer_.data()); }
  const T* data() const { return reinterpret_cast<const T*>(buffer_.data()); }
  T* get() { return data(); }
  const T* get() const { return data(); }
  T& operator[](std::size_t i) { return data()[i]; }
  const T& operator[](std::size_t i) const { return data()[i]; }
  std::size_t size() const { return size_; }

 private:
  AlignedBuffer buffer_;
  std::size_t size_ = 0;
};

}  // namespace msbvh
