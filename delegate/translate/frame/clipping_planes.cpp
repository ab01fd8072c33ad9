#include "delegate/translate/frame/clipping_planes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

std::optional<ClippingPlane> unit_plane(const std::array<double, 4>& plane) {
  const double largest = std::max({std::abs(plane[0]), std::abs(plane[1]), std::abs(plane[2])});
  if (!(largest > 0.0) || !std::ranges::all_of(plane, [](double each) { return std::isfinite(each); }))
    return std::nullopt;
  // By the largest first, whose square may be out of range.
  const Vec3d scaled{plane[0] / largest, plane[1] / largest, plane[2] / largest};
  const double unit = 1.0 / length(scaled), offset = plane[3] / largest * unit;
  const ClippingPlane result{Vec3f(scaled * unit), float(offset)};
  return std::isfinite(result.offset) ? std::optional(result) : std::nullopt;
}

}  // namespace

std::vector<ClippingPlane> checked_planes(const std::string& path,
                                          std::span<const std::array<double, 4>> planes,
                                          std::vector<Diagnostic>& diagnostics) {
  std::vector<ClippingPlane> result;
  for (const std::array<double, 4>& plane : planes) {
    if (const std::optional<ClippingPlane> unit = unit_plane(plane)) {
      result.push_back(*unit);
      continue;
    }
    diagnostics.push_back(
        {Severity::kWarning, path, "clippingPlanes",
         message("found (", text(plane[0]), ", ", text(plane[1]), ", ", text(plane[2]), ", ", text(plane[3]),
                 "), expected finite numbers of which the first three are a direction; left "
                 "out")});
  }
  return result;
}

}  // namespace msbvh::translate
