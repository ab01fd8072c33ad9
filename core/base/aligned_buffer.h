// Uninitialised bytes on a cache-line boundary, on huge pages where the system has them: random rays touch
// the whole tree, and the misses of the address translation cost as much as those of the cache. Copies share
// the bytes, which are written before the first copy is made.
#pragma once

#include <cstddef>
#include <memory>

namespace msbvh {

class AlignedBuffer {
 public:
  static constexpr std::size_t kAlignment = 64;

  AlignedBuffer() = default;
  explicit AlignedBuffer(std::size_t bytes);

  std::byte* data() { return data_.get(); }
  const std::byte* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  std::shared_ptr<std::byte[]> data_;
  std::size_t size_ = 0;
};

}  // namespace msbvh
