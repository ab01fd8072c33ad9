#include "delegate/translate/frame/kept_origin.h"

#include <algorithm>

#include "core/base/box.h"
#include "delegate/translate/frame/camera_moments.h"

namespace msbvh::translate {
namespace {

// Of a position that far from the origin, of the camera's and of what moves relative to it: a rounding each.
constexpr double kRounding = 0x1p-23;

}  // namespace

std::optional<Vec3d> kept_origin(const std::optional<Vec3d>& last, const CameraInput& camera,
                                 std::uint32_t width, std::uint32_t height) {
  if (!last) return std::nullopt;
  double farthest = 0.0;
  Box3d eyes;
  for (const CameraSample& sample : camera.samples) {
    const Matrix4d& m = sample.world_from_camera;
    const Vec3d eye{m[12], m[13], m[14]};
    farthest = std::max(farthest, length(eye - *last));
    eyes.grow(eye);
  }
  const double nearest_pixel = pixel_size_of(camera, width, height).at_box(eyes);
  return farthest * kRounding <= kOriginPixels * nearest_pixel ? last : std::nullopt;
}

}  // namespace msbvh::translate
