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
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  auto* bytes_of_its_own = static_cast<std::byte*>(std::aligned_alloc(alignment, rounded));
  if (!bytes_of_its_own) throw std::bad_alloc();
  data_.reset(bytes_of_its_own, [](std::byte* p) { std::free(p); });
#ifdef MADV_HUGEPAGE
  if (alignment == kHugePage) madvise(data_.get(), rounded, MADV_HUGEPAGE);
#endif
}

}  // namespace msbvh
