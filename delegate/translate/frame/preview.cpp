#include "delegate/translate/frame/preview.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace msbvh::translate {
namespace {

// For each pixel of the larger picture, the smaller one's: [height][width].
std::vector<std::size_t> nearest_pixels(const Image& from, std::uint32_t width, std::uint32_t height) {
  std::vector<std::size_t> nearest;
  nearest.reserve(std::size_t(width) * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t row = y * from.height / height * from.width;
    for (std::size_t x = 0; x < width; ++x) nearest.push_back(row + x * from.width / width);
  }
  return nearest;
}

template <typename T>
void spread(const std::vector<T>& from, const std::vector<std::size_t>& nearest, std::size_t channels,
            std::vector<T>& to) {
  for (std::size_t pixel = 0; pixel < nearest.size(); ++pixel) {
    std::copy_n(from.begin() + std::ptrdiff_t(nearest[pixel] * channels), channels,
                to.begin() + std::ptrdiff_t(pixel * channels));
  }
}

}  // namespace

std::uint32_t preview_divisor(std::uint32_t width, std::uint32_t height, double seconds_a_sample) {
  const double whole = double(width) * height * seconds_a_sample;
  std::uint32_t divisor = 1;
  while (whole / (double(divisor) * divisor) > kPreviewSeconds &&
         std::min(width, height) / (2 * divisor) >= kLeastPreview) {
    divisor *= 2;
  }
  return divisor;
}

Image enlarged(const Image& picture, std::uint32_t width, std::uint32_t height) {
  const std::vector<std::size_t> nearest = nearest_pixels(picture, width, height);
  Image result{width, height, {}, {}, {}};
  result.rgba.resize(4 * nearest.size());
  spread(picture.rgba, nearest, 4, result.rgba);
  for (const AovImage& aov : picture.aovs) {
    AovImage& larger = result.aovs.emplace_back(aov.aov, nearest.size());
    if (form_of(aov.aov).is_id) {
      spread(aov.ids, nearest, 1, larger.ids);
    } else {
      spread(aov.values, nearest, form_of(aov.aov).numbers, larger.values);
    }
  }
  return result;
}

}  // namespace msbvh::translate
