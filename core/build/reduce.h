// Reductions over fixed chunks, added up in order: the same result for any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/base/parallel.h"

namespace msbvh {

// make() begins a sum, add(sum, begin, end) adds a range to it, join(sum, part) adds a later chunk's.
template <typename T, typename Make, typename Add, typename Join>
T reduce_in_chunks(std::size_t count, std::size_t chunk, const Make& make, const Add& add, const Join& join) {
  if (count <= chunk) {
    T sum = make();
    add(sum, 0, count);
    return sum;
  }
  std::vector<T> parts((count + chunk - 1) / chunk, make());
  parallel_for_ranges(count, chunk,
                      [&](std::size_t begin, std::size_t end) { add(parts[begin / chunk], begin, end); });
  for (std::size_t i = 1; i < parts.size(); ++i) join(parts[0], parts[i]);
  return parts[0];
}

}  // namespace msbvh
