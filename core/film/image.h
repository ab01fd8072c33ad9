// A picture: colour and alpha, and what else was asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/film/aov_sums.h"

namespace msbvh {

struct AovImage {
  Aov aov;
  std::vector<float> values;      // [height][width][numbers]; empty for ids
  std::vector<std::int32_t> ids;  // [height][width]; empty for others

  AovImage(Aov a, std::size_t pixels) : aov(a) {
    form_of(a).is_id ? ids.resize(pixels) : values.resize(pixels * form_of(a).numbers);
  }
  void set(std::size_t pixel, const AovTotals& totals) {
    if (form_of(aov).is_id) {
      ids[pixel] = totals.id(aov);
    } else {
      totals.resolve(aov, &values[pixel * form_of(aov).numbers]);
    }
  }
};

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgba;  // [height][width][4], top row first, linear, premultiplied; alpha is coverage
  std::vector<AovImage> aovs{};  // in the order in which they were asked for
  // [slice][height][width][4], where the shutter is kept in slices: as rgba, which they sum up to.
  std::vector<float> slices{};
};

}  // namespace msbvh
