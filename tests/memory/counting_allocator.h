// What this program's own code holds of the allocator's bytes: every operator new, by what the allocator has
// set aside for it (malloc_usable_size), and every aligned buffer, by what was asked for (behind a buffer on
// huge pages glibc keeps address space that nobody touches). Libraries that are loaded, TBB above all, are
// not counted: they keep memory for later.
#pragma once

#include <cstdint>

namespace msbvh::memory {

std::int64_t held_bytes();
std::int64_t held_blocks();
// The most that has been held at once since the last reset.
std::int64_t peak_bytes();
void reset_peak();

}  // namespace msbvh::memory
