#include "core/shade/light/shaping.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/lerp.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr float kDegrees = 180.0f / kPi;

Vec3f focused(const Light& light, const LightValues& values, float cosine) {
  if (!(values.focus > 0.0f)) return {1.0f, 1.0f, 1.0f};
  return lerp(light.focus_tint, Vec3f{1.0f, 1.0f, 1.0f}, std::pow(std::abs(cosine), values.focus));
}

float in_cone(const LightValues& values, float cosine) {
  const float degrees = std::acos(cosine) * kDegrees, cutoff = values.cone_angle_degrees;
  if (degrees > cutoff) return 0.0f;
  const float begin = cutoff * (1.0f - std::clamp(values.cone_softness, 0.0f, 1.0f));
  if (degrees <= begin) return 1.0f;
  const float t = (degrees - begin) / (cutoff - begin);
  return 1.0f - t * t * (3.0f - 2.0f * t);
}

float stretched(float vertical, float scale) {
  if (scale > 0.0f) return vertical / scale;
  return scale < 0.0f ? (vertical - 180.0f) / -scale + 180.0f : vertical;
}

float ies_share(const IesShaping& ies, const Vec3f& local) {
  const float vertical = std::acos(std::clamp(local.z, -1.0f, 1.0f)) * kDegrees;
  const float around = std::atan2(local.y, local.x) * kDegrees;
  const float found =
      ies_intensity(*ies.profile, std::clamp(stretched(vertical, ies.angle_scale), 0.0f, 180.0f),
                    around < 0.0f ? around + 360.0f : around);
  if (!ies.normalize) return found;
  return ies.profile->power > 0.0f ? found / ies.profile->power : 0.0f;
}

struct Between {
  std::size_t first;
  float w;
};

// Of increasing angles that hold `angle`.
Between between(std::span<const float> angles, float angle) {
  const auto after = std::ranges::upper_bound(angles, angle) - angles.begin();
  const auto first = std::clamp<std::ptrdiff_t>(after - 1, 0, static_cast<std::ptrdiff_t>(angles.size()) - 2);
  const float begin = angles[std::size_t(first)], end = angles[std::size_t(first) + 1];
  return {std::size_t(first), (angle - begin) / (end - begin)};
}

}  // namespace

float ies_intensity(const IesProfile& profile, float vertical, float horizontal) {
  if (vertical < profile.vertical.front() || vertical > profile.vertical.back()) return 0.0f;
  const Between v = between(profile.vertical, vertical);
  const Between h = between(profile.horizontal,
                            std::clamp(horizontal, profile.horizontal.front(), profile.horizontal.back()));
  const auto at = [&](std::size_t row) {
    const float* candela = profile.candela.data() + row * profile.vertical.size() + v.first;
    return lerp(candela[0], candela[1], v.w);
  };
  return lerp(at(h.first), at(h.first + 1), h.w);
}

bool is_shaped(const Light& light, const LightValues& values) {
  const bool has_place =
      light.kind != LightKind::kDistant && light.kind != LightKind::kDome && light.kind != LightKind::kCamera;
  return has_place && (values.focus > 0.0f || values.cone_angle_degrees < 180.0f || light.ies.profile);
}

Vec3f shaping(const PlacedLight& light, const Vec3f& to_light) {
  const float cosine = std::clamp(dot(to_light, light.axis), -1.0f, 1.0f);
  Vec3f left = focused(*light.source, light.values, cosine) * in_cone(light.values, cosine);
  if (light.source->ies.profile)
    left = left * ies_share(light.source->ies, normalize(light.light_from_world.vector(to_light)));
  return left;
}

}  // namespace msbvh
