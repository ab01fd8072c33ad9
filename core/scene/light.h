// Lights: their kinds, what they give, how they move.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "core/base/vec.h"

namespace msbvh {

enum class LightKind : std::uint8_t {
  kDistant,  // shines along -z of its space from a disc of `angle_degrees` across
  kDome,     // constant, from everywhere
  kSphere,   // `radius`, at the origin of its space; radius 0: a point
  kRect,     // `width` x `height` in the xy plane of its space, shines along -z
  kCamera    // usdrecord's camera light: at the camera, unit irradiance times pi at any distance, casts no
             // shadow
};

// What a light gives, and how large it is.
struct LightValues {
  // Radiance leaving the light (distant: see normalize in UsdLux; intensity, exposure, colour and
  // normalisation are already multiplied in by the front-end). Point lights (radius 0): radiant intensity.
  Vec3f radiance{1.0f, 1.0f, 1.0f};
  float angle_degrees = 0.53f;
  float radius = 0.5f;
  float width = 1.0f;
  float height = 1.0f;
  bool operator==(const LightValues&) const = default;
};

struct Light : LightValues {  // its values while nothing but the transform moves
  std::string name;
  LightKind kind = LightKind::kDistant;
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_light;  // key_count(segments)
  // Empty, or key_count(segments): taken instead. A radius or angle that is 0 at one key is so at all of
  // them.
  std::vector<LightValues> moving_values;
};

// Whether it gives anything at any time; a light that does not takes no part in the rendering.
inline bool shines(const Light& light) {
  const auto bright = [](const LightValues& values) { return !(values.radiance == Vec3f{}); };
  return light.moving_values.empty() ? bright(light) : std::ranges::any_of(light.moving_values, bright);
}

// Whether it is the same, in the same place, throughout the shutter. Where a dome or a camera light stands is
// of no matter.
inline bool is_still(const Light& light) {
  const bool placeless = light.kind == LightKind::kDome || light.kind == LightKind::kCamera;
  return light.segments == 0 || (placeless && light.moving_values.empty());
}

}  // namespace msbvh
