// Linear interpolation in tables.
#pragma once

#include <algorithm>
#include <cstddef>

namespace msbvh {

// Between the entries of a table of `size` along one axis, at `place` in [0, 1].
struct Between {
  std::size_t index;
  float weight;

  Between(float place, std::size_t size) {
    const float scaled = std::clamp(place, 0.0f, 1.0f) * float(size - 1);
    index = std::min(static_cast<std::size_t>(scaled), size - 2);
    weight = scaled - float(index);
  }
  // `at`: an entry, by its index.
  template <typename At>
  float of(const At& at) const {
    const float first = at(index);
    return first + (at(index + 1) - first) * weight;
  }
};

}  // namespace msbvh
