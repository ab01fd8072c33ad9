// What one sample of a pixel brings to the film, and the sum of many.
#pragma once

#include <cstdint>

#include "core/base/vec.h"

namespace msbvh {

struct FilmSample {
  Vec3f radiance;      // premultiplied
  float alpha = 0.0f;  // 1: a surface was seen, the dome is not one
};

// Double: the sum of a million floats would have lost its last digits.
struct FilmSum {
  Vec3d radiance;
  double alpha = 0.0;

  FilmSum& operator+=(const FilmSample& sample) {
    radiance += Vec3d(sample.radiance);
    alpha += double(sample.alpha);
    return *this;
  }
  FilmSum& operator+=(const FilmSum& other) {
    radiance += other.radiance;
    alpha += other.alpha;
    return *this;
  }
  // The mean of `count` samples, four floats: box filter over the pixel, premultiplied.
  void resolve(std::uint32_t count, float* rgba) const {
    const Vec3d mean = radiance * (1.0 / count);
    rgba[0] = static_cast<float>(mean.x);
    rgba[1] = static_cast<float>(mean.y);
    rgba[2] = static_cast<float>(mean.z);
    rgba[3] = static_cast<float>(alpha / count);
  }
};

}  // namespace msbvh
