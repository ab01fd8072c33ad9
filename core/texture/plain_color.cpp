#include "core/texture/plain_color.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/texture/color_conversion.h"

namespace msbvh {

void convert_colors(std::span<float> rgb, const std::string& from, const std::string& to) {
  const std::string space = from.empty() ? kLinearRec709 : from;
  if (space == to || space == "unknown") return;
  const ColorConversion conversion(space, to);
  if (!conversion.changes()) return;
  const std::vector<float> before(rgb.begin(), rgb.end());
  conversion.apply(rgb, 3);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    if (rgb[i] < 0.0f && before[i] >= 0.0f) rgb[i] = 0.0f;
  }
  // The conversion makes NaN of all three where one is not finite.
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    if (!std::isfinite(before[i])) rgb[i] = before[i];
  }
}

}  // namespace msbvh
