#include "delegate/translate/light.h"

#include <cmath>

#include "core/motion/track.h"
#include "delegate/translate/linear_transform_fit.h"

namespace msbvh::translate {
namespace {

bool is_at_infinity(LightKind kind) { return kind == LightKind::kDistant || kind == LightKind::kDome; }

// Around what shines, in the light's space; for lights at infinity around the directions.
Box3d box_of(const Light& light) {
  switch (light.kind) {
    case LightKind::kDistant:
    case LightKind::kDome:
      return {{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}};
    case LightKind::kRect:
      return {{-0.5 * light.width, -0.5 * light.height, 0.0}, {0.5 * light.width, 0.5 * light.height, 0.0}};
    case LightKind::kSphere: {
      const double r = light.radius;
      return {{-r, -r, -r}, {r, r, r}};
    }
    case LightKind::kCamera:
      break;
  }
  return {{}, {}};
}

bool check_size(float value, const char* attribute, PrimLog& log) {
  if (std::isfinite(value) && value >= 0.0f) return true;
  return log.reject(attribute, message("found ", value, "; expected a finite number that is not negative"));
}

bool check(const LightInput& input, PrimLog& log) {
  const Light& light = input.light;
  if (!is_finite(light.radiance)) {
    return log.reject("inputs:intensity",
                      "the radiance is not finite; expected finite intensity, exposure and colour");
  }
  if (!(light.angle_degrees >= 0.0f && light.angle_degrees <= 360.0f)) {
    return log.reject("inputs:angle", message("found ", light.angle_degrees, "; expected 0 to 360 degrees"));
  }
  return check_size(light.radius, "inputs:radius", log) && check_size(light.width, "inputs:width", log) &&
         check_size(light.height, "inputs:height", log) &&
         check_transform(input.world_from_light, "xformOpOrder", log);
}

// Directions do not depend on where the light stands.
TransformTrack without_translation(const TransformSamples& samples) {
  TransformSamples turned = samples;
  for (Matrix4d& m : turned.matrices) m[12] = m[13] = m[14] = 0.0;
  return TransformTrack(turned);
}

}  // namespace

std::optional<Light> translate_light(const LightInput& input, const ScreenMeasure& measure,
                                     const Vec3d& origin, std::uint32_t width, std::uint32_t height,
                                     const FitSettings& settings, PrimLog& log) {
  if (!check(input, log)) return std::nullopt;
  const bool at_infinity = is_at_infinity(input.light.kind);
  const Box3d box = box_of(input.light);
  const TransformTrack transform = at_infinity ? without_translation(input.world_from_light)
                                               : TransformTrack(input.world_from_light).rebased({}, origin);
  const LinearTransformFitter fitter(
      transform, at_infinity ? ScreenMeasure::filled_by(box, width, height) : measure, settings);
  const Fit fit = fitter.fit(corners_of(box));
  report_fit(fit, settings.tolerance, "xformOpOrder", "the light's motion", "", log);
  Light light = input.light;
  light.segments = fit.segments;
  light.world_from_light.resize(key_count(fit.segments));
  fitter.keys(fit.segments, light.world_from_light.data());
  return light;
}

}  // namespace msbvh::translate
