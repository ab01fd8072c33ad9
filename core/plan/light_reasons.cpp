#include "core/plan/light_reasons.h"

#include <algorithm>
#include <string>

#include "core/plan/phrases.h"

namespace msbvh {
namespace {

// The largest at any key, which is what asks for sampling an extent.
float largest(const Light& light, float LightValues::*size) {
  float result = light.moving_values.empty() ? light.*size : 0.0f;
  for (const LightValues& values : light.moving_values) result = std::max(result, values.*size);
  return result;
}

template <typename Asks>
bool any_values(const Light& light, const Asks& asks) {
  return light.moving_values.empty() ? asks(static_cast<const LightValues&>(light))
                                     : std::ranges::any_of(light.moving_values, asks);
}

std::string image_phrase(const LightImage& image) {
  return std::to_string(image.width) + " x " + std::to_string(image.height) + " texels";
}

// Empty where it has none that a ray could meet.
std::string extent_phrase(const Light& light) {
  const float angle = largest(light, &LightValues::angle_degrees);
  const float radius = largest(light, &LightValues::radius);
  switch (light.kind) {
    case LightKind::kDistant:
      return angle > 0.0f ? phrase(angle, " degrees across") : "";
    case LightKind::kSphere:
      return radius > 0.0f ? "radius " + phrase(radius, "") : "";
    case LightKind::kDisk:
      return "disk of radius " + phrase(radius, "");
    case LightKind::kCylinder:
      return "cylinder of radius " + phrase(radius, ", length ") +
             phrase(largest(light, &LightValues::length), "");
    case LightKind::kRect:
      return phrase(largest(light, &LightValues::width), " x ") +
             phrase(largest(light, &LightValues::height), "");
    case LightKind::kDome:
      return light.image ? "textured dome" : "";
    case LightKind::kMesh:
      return "mesh";
    case LightKind::kCamera:
      break;
  }
  return "";
}

bool leaves_out_some(const std::vector<std::uint8_t>& groups) {
  return std::ranges::find(groups, std::uint8_t(0)) != groups.end();
}

// Empty where it has none.
std::string controls_phrase(const Light& light) {
  if (light.kind == LightKind::kMesh) return "mesh";
  const auto placed = [&] { return light.kind != LightKind::kDistant && light.kind != LightKind::kDome; };
  if (light.kind == LightKind::kRect && light.image) return "textured, " + image_phrase(*light.image);
  if (placed() && light.ies.profile) return "IES profile";
  if (placed() && any_values(light, [](const LightValues& v) { return v.cone_angle_degrees < 180.0f; }))
    return "cone";
  if (placed() && any_values(light, [](const LightValues& v) { return v.focus > 0.0f; })) return "focus";
  if (any_values(light, [](const LightValues& v) { return v.diffuse != 1.0f || v.specular != 1.0f; }))
    return "diffuse or specular multiplier";
  if (light.kind != LightKind::kCamera && !(light.shadow == LightShadow{})) return "shadow settings";
  if (leaves_out_some(light.lit_groups)) return "light link";
  return leaves_out_some(light.shadow_groups) ? "shadow link" : "";
}

}  // namespace

std::vector<Reason> light_reasons(const Light& light) {
  std::vector<Reason> reasons;
  if (!shines(light)) return reasons;
  const auto add = [&](Effect effect, const std::string& why) {
    if (!why.empty()) reasons.push_back({effect, light.name, why});
  };
  std::uint32_t segments = light.segments;
  for (const LightPortal& portal : light.portals) segments = std::max(segments, portal.segments);
  if (!is_still(light)) add(Effect::kMovingLights, segments_phrase(segments));
  if (light.kind == LightKind::kDome && !light.image) add(Effect::kDomeLight, "constant dome");
  if (is_image_dome(light)) add(Effect::kImageDome, "textured dome, " + image_phrase(*light.image));
  add(Effect::kAreaLights, extent_phrase(light));
  add(Effect::kLightControls, controls_phrase(light));
  return reasons;
}

}  // namespace msbvh
