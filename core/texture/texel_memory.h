// What textures may hold in memory, shared by all of a TextureCache.
#pragma once

#include <atomic>
#include <cstdint>

namespace msbvh {

// Pictures that their format stores in rows are decoded once and held, as the file stores them, in up to half
// of the limit; tiles take what is left.
class TexelMemory {
 public:
  explicit TexelMemory(std::uint64_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // False, and nothing is held, where it would pass the half.
  bool hold(std::uint64_t bytes) {
    std::uint64_t held = held_bytes_.load();
    do {
      if (bytes > limit_bytes_ / 2 || held > limit_bytes_ / 2 - bytes) return false;
    } while (!held_bytes_.compare_exchange_weak(held, held + bytes));
    return true;
  }
  void release(std::uint64_t bytes) { held_bytes_ -= bytes; }

  std::uint64_t limit_bytes() const { return limit_bytes_; }
  std::uint64_t held_bytes() const { return held_bytes_.load(); }

  void count_read(std::uint64_t bytes) { read_bytes_ += bytes; }
  std::uint64_t read_bytes() const { return read_bytes_.load(); }

 private:
  std::uint64_t limit_bytes_;
  std::atomic<std::uint64_t> held_bytes_{0}, read_bytes_{0};
};

}  // namespace msbvh
