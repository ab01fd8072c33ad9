#include "delegate/translate/look/light_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace msbvh::translate {
namespace {

bool mend(float& value) {
  const bool finite = std::isfinite(value);
  if (!finite) value = value > 0.0f ? kBrightestTexel : 0.0f;
  value = std::max(value, 0.0f);
  return !finite;
}

std::vector<Vec3f> smaller(const std::vector<Vec3f>& texels, std::uint32_t width, std::uint32_t step,
                           std::uint32_t new_width, std::uint32_t new_height) {
  std::vector<Vec3f> result;
  result.reserve(std::size_t(new_width) * new_height);
  for (std::uint32_t y = 0; y < new_height; ++y) {
    for (std::uint32_t x = 0; x < new_width; ++x) {
      Vec3d sum;
      for (std::uint32_t j = 0; j < step; ++j) {
        for (std::uint32_t i = 0; i < step; ++i)
          sum = sum + Vec3d(texels[std::size_t(y * step + j) * width + x * step + i]);
      }
      result.push_back(Vec3f(sum * (1.0 / (double(step) * step))));
    }
  }
  return result;
}

}  // namespace

LightPicture light_picture(const std::string& name, ImageMap map, std::uint32_t width, std::uint32_t height,
                           std::vector<Vec3f> texels) {
  LightPicture picture;
  for (Vec3f& texel : texels) {
    const bool x = mend(texel.x), y = mend(texel.y), z = mend(texel.z);
    picture.mended += x || y || z;
  }
  std::uint32_t step = 1;
  while (std::size_t(width / step) * (height / step) > kMostLightTexels) ++step;
  if (step > 1 && texels.size() == std::size_t(width) * height) {
    texels = smaller(texels, width, step, width / step, height / step);
    width /= step;
    height /= step;
  }
  picture.image = light_image(name, map, width, height, std::move(texels));
  return picture;
}

std::optional<ImageMap> dome_map(std::string_view format) {
  if (format == "automatic" || format == "latlong") return ImageMap::kLatlong;
  if (format == "angular") return ImageMap::kAngular;
  if (format == "mirroredBall") return ImageMap::kMirroredBall;
  return std::nullopt;
}

}  // namespace msbvh::translate
