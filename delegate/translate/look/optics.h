// What a camera's optics mean: its window on the image plane, fitted to an image of another shape, and its
// lens. UsdGeomCamera: apertures, their offsets and the focal length share a unit, a tenth of the stage's.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/scene/camera.h"

namespace msbvh::translate {

// UsdGeomCamera's attributes at a time.
struct Optics {
  Projection projection = Projection::kPerspective;
  double horizontal_aperture = 0.0, vertical_aperture = 0.0;
  double horizontal_aperture_offset = 0.0, vertical_aperture_offset = 0.0;
  double focal_length = 0.0;
  double f_stop = 0.0, focus_distance = 0.0;
};

// left, right, bottom, top; as ScreenWindow (core/scene/camera.h) in double precision.
struct Window {
  double left, right, bottom, top;

  double width() const { return right - left; }
  double height() const { return top - bottom; }
};

Window window_of(const Optics& optics);

// f-number = focal length / diameter of the aperture; a pinhole where it or the focus distance is 0.
Lens thin_lens(const Optics& optics);

// UsdGeomCamera's exposure attributes at a time, with its defaults; `stops` is `exposure` itself.
struct Exposure {
  double stops = 0.0, time_seconds = 1.0, iso = 100.0, f_stop = 1.0, responsivity = 1.0;
};

// What the camera multiplies light by (UsdGeomCamera::ComputeLinearExposureScale): 1 for the defaults. Not
// finite, or negative, where the attributes make no sense.
double exposure_scale(const Exposure& exposure);

// UsdRenderSettings' aspectRatioConformPolicy.
enum class AspectPolicy {
  kExpandAperture,
  kCropAperture,
  kAdjustApertureWidth,
  kAdjustApertureHeight,
  kAdjustPixelAspectRatio
};
// Their tokens, in that order.
std::span<const std::string_view> aspect_policy_names();
std::optional<AspectPolicy> aspect_policy(std::string_view name);

struct Conformed {
  Window window;
  double pixel_aspect_ratio = 1.0;  // width of a pixel over its height
};
// The window that fills an image of width / height = `image_aspect`. Its centre stays where it is, so
// aperture offsets count once.
Conformed conformed(const Window& window, double image_aspect, AspectPolicy policy);

// The image's height by usdrecord's rule: rounded down, never below one pixel. In single precision as there:
// in double, the float 16:9 would make 539 lines of 960 columns.
std::int64_t image_height(std::int64_t width, double aspect_ratio);

}  // namespace msbvh::translate
