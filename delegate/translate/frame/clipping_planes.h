// A camera's clippingPlanes, as UsdGeomCamera has them: what lies below any of them is not seen by camera
// rays.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/scene/camera.h"
#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

// Of the camera at `path`: (a, b, c, d) each cuts off where a x + b y + c z + d < 0 in camera space. Planes
// with a number that is not finite are left out with a warning, and so are those without a direction, which
// would cut off everything or nothing. They are scaled to unit normals, so that single precision holds any.
std::vector<ClippingPlane> checked_planes(const std::string& path,
                                          std::span<const std::array<double, 4>> planes,
                                          std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
