// A first look at a picture: fewer pixels, shown as large as the picture will be.
#pragma once

#include <cstdint>

#include "core/film/image.h"

namespace msbvh::translate {

// What a first look may take. With the trees of an edit it has 200 ms; a picture of one sample a pixel that
// takes no longer needs none.
inline constexpr double kPreviewSeconds = 0.05;
// Of one sample of one pixel, before any has been timed.
inline constexpr double kAssumedSampleSeconds = 2e-6;
// A picture of fewer pixels than this in width or height shows nothing.
inline constexpr std::uint32_t kLeastPreview = 16;

// By how much width and height are divided: the least power of two that keeps to kPreviewSeconds; 1: no first
// look is needed, or there are too few pixels for one.
std::uint32_t preview_divisor(std::uint32_t width, std::uint32_t height, double seconds_a_sample);

// The same picture in more pixels, each with the values of the nearest one.
Image enlarged(const Image& picture, std::uint32_t width, std::uint32_t height);

}  // namespace msbvh::translate
