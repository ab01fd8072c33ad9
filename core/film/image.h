// A picture: colour and alpha, and what else was asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/film/aov.h"

namespace msbvh {

struct AovImage {
  Aov aov;
  std::vector<float> values;      // [height][width][channels]; empty for ids
  std::vector<std::int32_t> ids;  // [height][width]; empty for others

  AovImage(Aov a, std::size_t pixels) : aov(a) {
    form_of(a).is_id ? ids.resize(pixels) : values.resize(pixels * form_of(a).channels);
  }
  void set(std::size_t pixel, const AovSum& sum, std::uint32_t samples) {
    if (form_of(aov).is_id) {
      ids[pixel] = sum.id(aov);
    } else {
      sum.resolve(aov, samples, &values[pixel * form_of(aov).channels]);
    }
  }
};

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgba;  // [height][width][4], top row first, linear, premultiplied; alpha is coverage
  std::vector<AovImage> aovs{};  // in the order in which they were asked for
};

}  // namespace msbvh
