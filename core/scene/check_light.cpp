#include "core/scene/check_light.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/scene/gate.h"

namespace msbvh {
namespace {

using namespace gate;

void check_light_values(const LightValues& values, LightKind kind, const std::string& part) {
  expect(is_finite(values.radiance), part, "radiance", "NaN or infinity", "a finite colour");
  if (kind == LightKind::kDistant) {
    expect(values.angle_degrees >= 0.0f && values.angle_degrees <= 360.0f, part, "angle",
           std::to_string(values.angle_degrees), "0 to 360 degrees");
  } else if (kind == LightKind::kSphere || kind == LightKind::kDisk || kind == LightKind::kCylinder) {
    expect_size(values.radius, part, "radius");
    if (kind == LightKind::kCylinder) expect_size(values.length, part, "length");
  } else if (kind == LightKind::kRect) {
    expect_size(values.width, part, "width");
    expect_size(values.height, part, "height");
  }
  expect_size(values.focus, part, "focus");
  expect_size(values.cone_angle_degrees, part, "coneAngle");
  expect(values.cone_softness >= 0.0f && values.cone_softness <= 1.0f, part, "coneSoftness",
         std::to_string(values.cone_softness), "0 to 1");
  expect_size(values.diffuse, part, "diffuse");
  expect_size(values.specular, part, "specular");
}

void check_ies(const IesProfile& profile, const std::string& part) {
  const std::size_t rows = profile.horizontal.size(), columns = profile.vertical.size();
  const auto increases = [](const std::vector<float>& angles) {
    return std::ranges::is_sorted(angles, std::less_equal<>()) && is_finite(angles.front()) &&
           is_finite(angles.back());
  };
  expect(rows >= 2 && columns >= 2 && profile.candela.size() == rows * columns, part, "ies",
         std::to_string(profile.candela.size()) + " intensities for " + std::to_string(rows) + " x " +
             std::to_string(columns) + " angles",
         "one for each pair of two angles at least");
  expect(increases(profile.horizontal) && increases(profile.vertical), part, "ies",
         "angles that do not increase", "increasing angles");
  expect_all_finite(profile.candela, part, "ies");
  expect_size(profile.power, part, "ies power");
}

void check_image(const LightImage& image, LightKind kind, const std::string& part) {
  const std::size_t texels = std::size_t(image.width) * image.height;
  const bool on_rect = image.map == ImageMap::kRect;
  expect(kind == (on_rect ? LightKind::kRect : LightKind::kDome), part, "image",
         on_rect ? "a rect's" : "a dome's", "an image of a rect on a rect, and of a dome on a dome");
  expect(texels > 0 && image.texels.size() == texels && image.columns.size() == texels &&
             image.rows.size() == image.height,
         part, "image", std::to_string(image.texels.size()) + " texels", "one at least, by light_image()");
}

void check_shadow(const LightShadow& shadow, const std::string& part) {
  expect(is_finite(shadow.color), part, "shadow colour", "NaN or infinity", "a finite colour");
  expect(!std::isnan(shadow.distance) && !std::isnan(shadow.falloff), part, "shadow distance", "NaN",
         "a number");
  expect(is_finite(shadow.falloff_gamma) && shadow.falloff_gamma > 0.0f, part, "shadow falloffGamma",
         std::to_string(shadow.falloff_gamma), "a finite number above 0");
}

// What does not change over the shutter.
void check_still_parts(const Light& light, std::uint32_t groups, const std::string& part) {
  expect(is_finite(light.focus_tint), part, "focusTint", "NaN or infinity", "a finite colour");
  if (light.image) check_image(*light.image, light.kind, part);
  if (light.ies.profile) check_ies(*light.ies.profile, part);
  expect(is_finite(light.ies.angle_scale), part, "ies angleScale", "NaN or infinity", "a finite number");
  check_shadow(light.shadow, part);
  for (const auto* link : {&light.lit_groups, &light.shadow_groups}) {
    expect(link->empty() || link->size() >= groups, part, "link", std::to_string(link->size()) + " groups",
           "none or " + std::to_string(groups));
  }
}

// Between a point and a light with an extent radiance would change its meaning.
void expect_all_points_or_none(const std::vector<LightValues>& values, float LightValues::*size,
                               const std::string& part, const std::string& attribute) {
  const auto is_point = [&](const LightValues& v) { return v.*size == 0.0f; };
  expect(std::all_of(values.begin(), values.end(), is_point) ||
             std::none_of(values.begin(), values.end(), is_point),
         part, attribute, "0 at some keys only", "0 at all keys or at none");
}

void check_moving_values(const Light& light, const std::string& part) {
  if (light.moving_values.empty()) return;
  expect_segments(light.segments, part, "radiance");
  expect(light.moving_values.size() == key_count(light.segments), part, "radiance",
         std::to_string(light.moving_values.size()) + " keys",
         "none or " + std::to_string(key_count(light.segments)));
  for (const LightValues& values : light.moving_values) check_light_values(values, light.kind, part);
  if (light.kind == LightKind::kSphere) {
    expect_all_points_or_none(light.moving_values, &LightValues::radius, part, "radius");
  } else if (light.kind == LightKind::kDistant) {
    expect_all_points_or_none(light.moving_values, &LightValues::angle_degrees, part, "angle");
  }
}

void check_portals(const Light& light, const std::string& part) {
  expect(light.portals.empty() || is_image_dome(light), part, "portals",
         std::to_string(light.portals.size()) + " portals", "none but on a dome with an image");
  for (const LightPortal& portal : light.portals) {
    expect_size(portal.width, part, "portal width");
    expect_size(portal.height, part, "portal height");
    expect_track(portal.world_from_portal, portal.segments, part, "worldFromPortal");
  }
}

}  // namespace

void check_light(const Light& light, std::uint32_t groups, const std::string& part) {
  check_still_parts(light, groups, part);
  check_light_values(light, light.kind, part);
  check_moving_values(light, part);
  check_portals(light, part);
  if (!is_placeless(light) || !light.world_from_light.empty()) {
    expect_track(light.world_from_light, light.segments, part, "worldFromLight");
  }
}

}  // namespace msbvh
