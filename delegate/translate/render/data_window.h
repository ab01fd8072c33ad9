// Which pixels a data window holds: a crop of the picture, or overscan around it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "delegate/translate/frame/camera_moments.h"

namespace msbvh::translate {

// The most pixels across that are rendered, and that files hold.
inline constexpr std::int64_t kMostPixelsAcross = 65535;

// Pixels of a picture of `display` size, from its upper left corner: x to the right, y downwards. Outside of
// the display window is overscan.
struct PixelWindow {
  std::int64_t x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelWindow&) const = default;
};

// UsdRender's rasterization rule (usdRender/overview.dox): a pixel counts whose centre lies within the
// window, its left and bottom edges included, its right and top ones not; so windows side by side neither
// overlap nor leave a gap. `ndc` is xmin, ymin, xmax, ymax with (0, 0) at the bottom left, increasing and
// finite. In single precision, as OpenUSD's own delegate multiplies: in double, 0.05f of 10 pixels would lie
// beyond the centre of the first. None where no centre lies within, and where that is more than
// kMostPixelsAcross.
std::optional<PixelWindow> pixel_window(const std::array<float, 4>& ndc, std::int64_t width,
                                        std::int64_t height);

// The part of the camera's window that those pixels of a picture of that size show.
WindowPart window_part(const PixelWindow& pixels, std::int64_t width, std::int64_t height);

}  // namespace msbvh::translate
