#include "delegate/translate/render/data_window.h"

#include <cmath>

namespace msbvh::translate {
namespace {

// The first pixel, counted upwards, whose centre is at `edge` or beyond. The product is rounded to single
// precision, what follows is not.
double first_from(float edge, std::int64_t pixels) { return std::ceil(double(edge * float(pixels)) - 0.5); }

struct Span {
  std::int64_t begin, count;
};

std::optional<Span> pixels_between(float low, float high, std::int64_t pixels) {
  const double begin = first_from(low, pixels), end = first_from(high, pixels);
  const auto most = double(kMostPixelsAcross);
  const bool fits = std::abs(begin) <= most && std::abs(end) <= most && end - begin <= most;
  if (!fits || !(begin < end)) return std::nullopt;
  return Span{std::int64_t(begin), std::int64_t(end - begin)};
}

}  // namespace

std::optional<PixelWindow> pixel_window(const std::array<float, 4>& ndc, std::int64_t width,
                                        std::int64_t height) {
  const auto columns = pixels_between(ndc[0], ndc[2], width);
  const auto rows = pixels_between(ndc[1], ndc[3], height);  // from the bottom
  if (!columns || !rows) return std::nullopt;
  return PixelWindow{columns->begin, height - (rows->begin + rows->count), columns->count, rows->count};
}

WindowPart window_part(const PixelWindow& pixels, std::int64_t width, std::int64_t height) {
  const auto w = double(width), h = double(height);
  return {double(pixels.x) / w, double(pixels.x + pixels.width) / w,
          1.0 - double(pixels.y + pixels.height) / h, 1.0 - double(pixels.y) / h};
}

}  // namespace msbvh::translate
