#include "core/texture/color_conversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <vector>

#include "core/base/error.h"

namespace msbvh {
namespace {

constexpr const char* kSrgb = "srgb_rec709_scene";
constexpr const char* kLinearOfSrgb = "lin_rec709_scene";

// One at a time: a config remembers the processors that it made.
OIIO::ColorProcessorHandle make_processor(const std::string& from, const std::string& to) {
  static std::mutex mutex;
  static const OIIO::ColorConfig config("ocio://default");
  const std::lock_guard lock(mutex);
  for (const std::string& name : {from, to})
    if (config.getColorSpaceIndex(name) < 0)
      throw Error("colour space '" + name + "': found no such name; expected one of OpenColorIO's built-in " +
                  "config, e.g. srgb_tx, lin_rec709_scene or acescg");
  if (config.equivalent(from, to)) return nullptr;
  OIIO::ColorProcessorHandle made = config.createColorProcessor(from, to);
  if (made == nullptr) throw Error("colour space '" + from + "': " + config.geterror());
  return made;
}

bool is_srgb(const std::string& name) {
  static const std::array names{"sRGB", "srgb_tx", kSrgb, "sRGB - Texture", "sRGB Encoded Rec.709 (sRGB)"};
  return std::any_of(names.begin(), names.end(), [&](const char* each) { return name == each; });
}

bool is_raw(const std::string& name) {
  return name.empty() || name == "raw" || name == "Raw" || name == "data" || name == "identity" ||
         name == "unknown";
}

float linear_of_srgb(float value) {
  if (std::abs(value) <= 0.04045f) return value / 12.92f;
  return std::copysign(std::pow((std::abs(value) + 0.055f) / 1.055f, 2.4f), value);
}

float linear_of_eight_bits(float value) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> result{};
    for (int i = 0; i < 256; ++i) result[i] = linear_of_srgb(static_cast<float>(i) / 255.0f);
    return result;
  }();
  return table[static_cast<std::size_t>(std::lround(value * 255.0f))];
}

}  // namespace

ColorConversion::ColorConversion(const std::string& from, const std::string& to) {
  if (is_raw(from)) return;
  srgb_ = is_srgb(from);
  if (srgb_ && to == kLinearOfSrgb) return;
  processor_ = make_processor(srgb_ ? kLinearOfSrgb : from, to);
}

void ColorConversion::apply(std::span<float> pixels, int channels, bool eight_bits) const {
  const std::size_t count = pixels.size() / static_cast<std::size_t>(channels);
  if (channels >= 3) return apply_to_rgb(pixels.data(), channels, count, eight_bits);
  std::vector<float> rgb(3 * count);
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = pixels[i / 3 * channels];
  apply_to_rgb(rgb.data(), 3, count, eight_bits);
  for (std::size_t i = 0; i < count; ++i) pixels[i * channels] = rgb[3 * i];
}

void ColorConversion::apply_to_rgb(float* rgb, int stride, std::size_t count, bool eight_bits) const {
  std::vector<std::size_t> not_finite;
  for (std::size_t i = 0; i < count; ++i) {
    float* pixel = rgb + i * stride;
    if (!std::isfinite(pixel[0] + pixel[1] + pixel[2]))
      not_finite.push_back(i);
    else if (srgb_)
      std::transform(pixel, pixel + 3, pixel, eight_bits ? linear_of_eight_bits : linear_of_srgb);
  }
  if (processor_ == nullptr) return;
  const auto bytes = static_cast<OIIO::stride_t>(stride * sizeof(float));
  processor_->apply(rgb, static_cast<int>(count), 1, 3, sizeof(float), bytes,
                    bytes * static_cast<OIIO::stride_t>(count));
  // A processor may clamp what is no number to one.
  for (std::size_t i : not_finite) std::fill_n(rgb + i * stride, 3, std::nanf(""));
}

}  // namespace msbvh
