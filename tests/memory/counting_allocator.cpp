// Replaces the operators, and stands between our code and posix_memalign and free: the linker's --wrap
// (tests/CMakeLists.txt).
#include "tests/memory/counting_allocator.h"

#include <atomic>
#include <cstdlib>
#include <malloc.h>
#include <mutex>
#include <new>

extern "C" {
int __real_posix_memalign(void** at, std::size_t alignment, std::size_t bytes);
void __real_free(void* at);
int __wrap_posix_memalign(void** at, std::size_t alignment, std::size_t bytes);
void __wrap_free(void* at);
}

namespace msbvh::memory {
namespace {

std::atomic<std::int64_t> held{0}, blocks{0}, peak{0};

void add(std::size_t bytes) {
  ++blocks;
  const std::int64_t now = held += static_cast<std::int64_t>(bytes);
  std::int64_t most = peak;
  while (now > most && !peak.compare_exchange_weak(most, now)) {
  }
}

void take_away(std::size_t bytes) {
  --blocks;
  held -= static_cast<std::int64_t>(bytes);
}

// Few are alive at a time: scratch of sets that are still to be divided, arenas of slices.
class AlignedBlocks {
 public:
  void add(void* at, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (count_ == kMost) std::abort();
    blocks_[count_++] = {at, bytes};
  }
  // 0: it is none.
  std::size_t remove(void* at) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < count_; ++i) {
      if (blocks_[i].at != at) continue;
      const std::size_t bytes = blocks_[i].bytes;
      blocks_[i] = blocks_[--count_];
      return bytes;
    }
    return 0;
  }

 private:
  static constexpr std::size_t kMost = 4096;
  struct Block {
    void* at;
    std::size_t bytes;
  };
  Block blocks_[kMost];
  std::size_t count_ = 0;
  std::mutex mutex_;
};

AlignedBlocks& aligned_blocks() {
  static AlignedBlocks all;
  return all;
}

void* counted(void* at) {
  if (!at) throw std::bad_alloc();
  add(malloc_usable_size(at));
  return at;
}

}  // namespace

std::int64_t held_bytes() { return held; }
std::int64_t held_blocks() { return blocks; }
std::int64_t peak_bytes() { return peak; }
void reset_peak() { peak = held.load(); }

}  // namespace msbvh::memory

using namespace msbvh::memory;

void* operator new(std::size_t bytes) { return counted(std::malloc(bytes)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  const auto unit = static_cast<std::size_t>(alignment);
  return counted(std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit));
}
void operator delete(void* at) noexcept {
  if (at) take_away(malloc_usable_size(at));
  __real_free(at);
}
void operator delete(void* at, std::size_t) noexcept { operator delete(at); }
void operator delete(void* at, std::align_val_t) noexcept { operator delete(at); }
void operator delete(void* at, std::size_t, std::align_val_t) noexcept { operator delete(at); }

int __wrap_posix_memalign(void** at, std::size_t alignment, std::size_t bytes) {
  const int failed = __real_posix_memalign(at, alignment, bytes);
  if (failed) return failed;
  aligned_blocks().add(*at, bytes);
  add(bytes);
  return 0;
}

void __wrap_free(void* at) {
  if (const std::size_t bytes = at ? aligned_blocks().remove(at) : 0) take_away(bytes);
  __real_free(at);
}
