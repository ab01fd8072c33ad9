#include "delegate/translate/light.h"

#include <algorithm>
#include <cmath>

#include "core/motion/track.h"
#include "delegate/translate/linear_transform_fit.h"
#include "delegate/translate/look/light_radiance.h"
#include "delegate/translate/moving_light.h"
#include "delegate/translate/time_samples.h"

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
    case LightKind::kDisk: {
      const double r = light.radius;
      return {{-r, -r, 0.0}, {r, r, 0.0}};
    }
    case LightKind::kCylinder: {
      const double r = light.radius, half = 0.5 * light.length;
      return {{-half, -r, -r}, {half, r, r}};
    }
    case LightKind::kCamera:
    case LightKind::kMesh:
      break;
  }
  return {{}, {}};
}

bool check_size(float value, const char* attribute, PrimLog& log) {
  if (std::isfinite(value) && value >= 0.0f) return true;
  return log.reject(attribute, message("found ", value, "; expected a finite number that is not negative"));
}

bool check_values(const LightValues& values, PrimLog& log) {
  if (!is_finite(values.radiance)) {
    return log.reject("inputs:intensity",
                      "the radiance is not finite; expected finite intensity, exposure and colour");
  }
  if (!(values.angle_degrees >= 0.0f && values.angle_degrees <= 360.0f)) {
    return log.reject("inputs:angle", message("found ", values.angle_degrees, "; expected 0 to 360 degrees"));
  }
  return std::ranges::all_of(kLightNumbers, [&](const LightNumber& each) {
    return check_size(values.*each.value, message("inputs:", each.input).c_str(), log);
  });
}

bool check_all_points_or_none(const LightInput& input, float LightValues::*size, const char* attribute,
                              PrimLog& log) {
  const auto is_point = [&](const LightValues& v) { return v.*size == 0.0f; };
  const auto points = std::count_if(input.values.begin(), input.values.end(), is_point);
  if (points == 0 || std::size_t(points) == input.values.size()) return true;
  return log.reject(attribute, message("found 0 in ", points, " of ", input.values.size(),
                                       " samples; expected 0 in all or in none"));
}

bool check_samples(const LightInput& input, PrimLog& log) {
  if (input.values.empty() && input.values_times01.empty()) return true;
  if (!check_times(input.values_times01, "inputs:intensity", log)) return false;
  if (input.values.size() != input.values_times01.size()) {
    return log.reject("inputs:intensity",
                      message("found ", input.values.size(), " values; expected one for each of ",
                              input.values_times01.size(), " times"));
  }
  for (const LightValues& values : input.values) {
    if (!check_values(values, log)) return false;
  }
  return (input.light.kind != LightKind::kSphere ||
          check_all_points_or_none(input, &LightValues::radius, "inputs:radius", log)) &&
         (input.light.kind != LightKind::kDistant ||
          check_all_points_or_none(input, &LightValues::angle_degrees, "inputs:angle", log));
}

bool check(const LightInput& input, PrimLog& log) {
  return check_values(input.light, log) && check_samples(input, log) &&
         check_transform(input.world_from_light, "xformOpOrder", log);
}

bool is_plain(const LightLook& look) {
  return look.shadow == LightShadow{} && look.lit_groups.empty() && look.shadow_groups.empty();
}

// A constant dome is what rays meet that meet nothing else: no surface asks it for light. One with controls,
// or with portals that say where to look, is asked, as an image dome is.
void ask_dome(const LightInput& input, Light& light) {
  if (light.kind != LightKind::kDome || light.image) return;
  const auto multiplies = [](const LightValues& v) { return v.diffuse != 1.0f || v.specular != 1.0f; };
  if (is_plain(light) && input.portals.empty() && !multiplies(light) &&
      std::ranges::none_of(input.values, multiplies))
    return;
  light.image = light_image(light.name, ImageMap::kLatlong, 1, 1, {{1.0f, 1.0f, 1.0f}});
}

// Directions do not depend on where the light stands.
TransformTrack without_translation(const TransformSamples& samples) {
  TransformSamples turned = samples;
  for (Matrix4d& m : turned.matrices) m[12] = m[13] = m[14] = 0.0;
  return TransformTrack(turned);
}

// Those that cannot be used are left out, with an error.
std::vector<LightPortal> portals_of(const LightInput& input, const ScreenMeasure& measure,
                                    const Vec3d& origin, const FitSettings& settings, PrimLog& log) {
  std::vector<LightPortal> portals;
  for (const PortalInput& portal : input.portals) {
    if (!check_size(portal.width, "portals", log) || !check_size(portal.height, "portals", log) ||
        !check_transform(portal.world_from_portal, "portals", log))
      continue;
    const double x = 0.5 * portal.width, y = 0.5 * portal.height;
    const TransformTrack track = TransformTrack(portal.world_from_portal).rebased({}, origin);
    const LinearTransformFitter fitter(track, measure, settings);
    LightPortal& placed = portals.emplace_back(LightPortal{portal.width, portal.height, 0, {}});
    placed.segments = fitter.fit(corners_of(Box3d{{-x, -y, 0.0}, {x, y, 0.0}})).segments;
    placed.world_from_portal.resize(key_count(placed.segments));
    fitter.keys(placed.segments, placed.world_from_portal.data());
  }
  return portals;
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
  const ScreenMeasure seen = at_infinity ? ScreenMeasure::filled_by(box, width, height) : measure;
  Light light = input.light;
  ask_dome(input, light);
  light.portals = portals_of(input, measure, origin, settings, log);
  if (!input.values.empty()) {
    fit_moving_light(input, transform, seen, settings, light, log);
    return light;
  }
  const LinearTransformFitter fitter(transform, seen, settings);
  const Fit fit = fitter.fit(corners_of(box));
  report_fit(fit, settings, "xformOpOrder", "the light's motion", log);
  light.segments = fit.segments;
  light.world_from_light.resize(key_count(fit.segments));
  fitter.keys(fit.segments, light.world_from_light.data());
  return light;
}

}  // namespace msbvh::translate
