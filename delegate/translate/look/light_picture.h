// From what a file holds to the image of a light.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/light_image.h"

namespace msbvh::translate {

// What has more is made smaller by a whole number, each texel a mean.
inline constexpr std::size_t kMostLightTexels = std::size_t(1) << 23;

struct LightPicture {
  std::shared_ptr<const LightImage> image;
  std::size_t mended = 0;  // texels that were not finite: NaN counts as 0, infinity as kBrightestTexel
};

inline constexpr float kBrightestTexel = 65504.0f;

// `texels` [height][width], linear, the uppermost row first; negative ones count as 0. Throws Error as
// light_image().
LightPicture light_picture(const std::string& name, ImageMap map, std::uint32_t width, std::uint32_t height,
                           std::vector<Vec3f> texels);

// By UsdLuxDomeLight's inputs:texture:format; none for what has no map here. automatic: latlong.
std::optional<ImageMap> dome_map(std::string_view format);

}  // namespace msbvh::translate
