#include "delegate/translate/look/optics.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

constexpr double kStageUnit =
    0.1;  // of apertures and focal lengths (GfCamera::APERTURE_UNIT, FOCAL_LENGTH_UNIT)
constexpr double kNoAspect = 1e-4;  // smaller aspect ratios say nothing: usdrecord takes a square

constexpr std::string_view kPolicies[] = {"expandAperture", "cropAperture", "adjustApertureWidth",
                                          "adjustApertureHeight", "adjustPixelAspectRatio"};

}  // namespace

Window window_of(const Optics& optics) {
  const bool perspective = optics.projection == Projection::kPerspective;
  const double scale = perspective ? kStageUnit / (optics.focal_length * kStageUnit) : kStageUnit;
  const double x = optics.horizontal_aperture_offset, half_width = optics.horizontal_aperture / 2.0;
  const double y = optics.vertical_aperture_offset, half_height = optics.vertical_aperture / 2.0;
  return {(x - half_width) * scale, (x + half_width) * scale, (y - half_height) * scale,
          (y + half_height) * scale};
}

Lens thin_lens(const Optics& optics) {
  if (optics.f_stop == 0.0 || optics.focus_distance == 0.0) return {};
  const double radius = optics.focal_length * kStageUnit / (2.0 * optics.f_stop);
  return {float(radius), float(optics.focus_distance)};
}

double exposure_scale(const Exposure& exposure) {
  return exposure.time_seconds * exposure.iso * std::exp2(exposure.stops) * exposure.responsivity /
         (100.0 * exposure.f_stop * exposure.f_stop);
}

std::span<const std::string_view> aspect_policy_names() { return kPolicies; }

std::optional<AspectPolicy> aspect_policy(std::string_view name) {
  const auto found = std::ranges::find(kPolicies, name);
  if (found == std::end(kPolicies)) return std::nullopt;
  return AspectPolicy(found - std::begin(kPolicies));
}

Conformed conformed(const Window& window, double image_aspect, AspectPolicy policy) {
  const double aspect = window.width() / window.height();
  if (policy == AspectPolicy::kAdjustPixelAspectRatio) return {window, aspect / image_aspect};
  const bool image_is_wider = image_aspect > aspect;
  const bool sets_width = policy == AspectPolicy::kAdjustApertureWidth ||
                          (policy == AspectPolicy::kExpandAperture && image_is_wider) ||
                          (policy == AspectPolicy::kCropAperture && !image_is_wider);
  const double width = sets_width ? window.height() * image_aspect : window.width();
  const double height = sets_width ? window.height() : window.width() / image_aspect;
  const double x = (window.left + window.right) / 2.0, y = (window.bottom + window.top) / 2.0;
  return {{x - width / 2.0, x + width / 2.0, y - height / 2.0, y + height / 2.0}};
}

std::int64_t image_height(std::int64_t width, double aspect_ratio) {
  const float aspect = std::abs(aspect_ratio) > kNoAspect ? float(aspect_ratio) : 1.0f;
  return std::max<std::int64_t>(std::int64_t(float(width) / aspect), 1);
}

}  // namespace msbvh::translate
