// From what an image file holds to the rendering space: done texel by texel, before anything is filtered.
#pragma once

#include <OpenImageIO/color.h>
#include <cstddef>
#include <span>
#include <string>

namespace msbvh {

class ColorConversion {
 public:
  // `from`: a colour space of OpenColorIO's built-in config, one of its aliases, or "sRGB"; "raw", "data",
  // "identity" and nothing: as they are. Throws Error where one of them is no colour space.
  ColorConversion(const std::string& from, const std::string& to);

  bool changes() const { return srgb_ || processor_ != nullptr; }
  // Of pixels of 1 to 4 channels: grey, grey and alpha, red, green and blue, and those with alpha. Alpha and
  // what is not finite stay as they are; of a grey pixel red is what is kept.
  // `eight_bits`: every value is a 255th, which is quicker.
  void apply(std::span<float> pixels, int channels, bool eight_bits = false) const;

 private:
  void apply_to_rgb(float* rgb, int stride, std::size_t count, bool eight_bits) const;

  // By the curve itself (IEC 61966-2-1), exact at white; the processor then begins at its linear space.
  bool srgb_ = false;
  OIIO::ColorProcessorHandle processor_;
};

}  // namespace msbvh
