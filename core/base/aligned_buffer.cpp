#include "core/base/aligned_buffer.h"

#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace msbvh {
namespace {

constexpr std::size_t kHugePage = std::size_t(2) << 20;

}  // namespace

AlignedBuffer::AlignedBuffer(std::size_t bytes) : size_(bytes) {
  if (bytes == 0) return;
  const std::size_t alignment = bytes >= kHugePage ? kHugePage : kAlignment;
  // To whole cache lines, not to whole huge pages: what lies behind the last line is never asked for.
  const std::size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  void* own = nullptr;
  if (posix_memalign(&own, alignment, rounded) != 0) throw std::bad_alloc();
  data_.reset(static_cast<std::byte*>(own), [](std::byte* p) { std::free(p); });
#ifdef MADV_HUGEPAGE
  if (alignment == kHugePage) madvise(data_.get(), rounded, MADV_HUGEPAGE);
#endif
}

}  // namespace msbvh
