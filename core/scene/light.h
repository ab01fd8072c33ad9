// Lights: their kinds, what they give, how they move.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "core/base/vec.h"
#include "core/scene/ies_profile.h"
#include "core/scene/light_image.h"

namespace msbvh {

enum class LightKind : std::uint8_t {
  kDistant,   // shines along -z of its space from a disc of `angle_degrees` across
  kDome,      // from everywhere, constant or by its image
  kSphere,    // `radius`, at the origin of its space; radius 0: a point
  kRect,      // `width` x `height` in the xy plane of its space, shines along -z
  kCamera,    // usdrecord's camera light: at the camera, unit irradiance times pi at any distance, casts no
              // shadow
  kDisk,      // `radius`, in the xy plane of its space, shines along -z
  kCylinder,  // `radius`, `length` along x, about the origin of its space; its ends do not shine
  kMesh       // all triangles of a mesh of the scene, on both sides, where they are at the time
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
  float length = 1.0f;
  // UsdLux's ShapingAPI, for all kinds that have a place: off the light's -z axis it gives less.
  float focus = 0.0f;  // a power of the cosine
  float cone_angle_degrees = 180.0f;
  float cone_softness = 0.0f;  // in [0, 1]
  // What diffuse and other reflection take of it.
  float diffuse = 1.0f;
  float specular = 1.0f;
  bool operator==(const LightValues&) const = default;
};

// UsdLux's ShadowAPI.
struct LightShadow {
  bool enabled = true;
  Vec3f color{};           // what is left of the light where it is shadowed
  float distance = -1.0f;  // farthest from the shadowed point that anything shadows it; negative: anywhere
  float falloff =
      -1.0f;  // over the last part of `distance` of this length shadows fade; not above 0: they do not
  float falloff_gamma = 1.0f;
  bool operator==(const LightShadow&) const = default;
};

// What of a light does not change over the shutter.
struct LightLook {
  std::shared_ptr<const LightImage> image{};  // of a dome or a rect, times its radiance; null: none
  Vec3f focus_tint{};                         // where `focus` dims it, it turns this colour
  IesShaping ies{};
  LightShadow shadow{};
  // By the light_group of geometry: 0 where it does not illuminate it, and where that does not shadow it.
  // Empty: all.
  std::vector<std::uint8_t> lit_groups{};
  std::vector<std::uint8_t> shadow_groups{};
};

// A rectangle through which a dome is seen: says where to look for its light, never what it gives.
struct LightPortal {
  float width = 1.0f, height = 1.0f;  // in the xy plane of its space; light comes through it along -z
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_portal;  // key_count(segments)
};

// What a mesh light shines from. One light stands for one place of a mesh.
struct LightSurface {
  static constexpr std::uint32_t kNoSet = 0xffffffffu;
  std::uint32_t mesh = 0;      // in Scene::meshes
  std::uint32_t set = kNoSet;  // in Scene::instances, of a prototype that holds it; kNoSet: in the world
  std::uint32_t instance = 0;  // in the set
  bool operator==(const LightSurface&) const = default;
};

struct Light : LightValues, LightLook {  // its values while nothing but the transform moves
  std::string name;
  LightKind kind = LightKind::kDistant;
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_light;  // key_count(segments)
  // Empty, or key_count(segments): taken instead. A radius or angle that is 0 at one key is so at all of
  // them.
  std::vector<LightValues> moving_values;
  LightSurface surface{};              // kMesh, which has no transform of its own
  std::vector<LightPortal> portals{};  // of a dome with an image
};

// Whether it gives anything at any time; a light that does not takes no part in the rendering.
inline bool shines(const Light& light) {
  const auto bright = [](const LightValues& values) { return !(values.radiance == Vec3f{}); };
  return light.moving_values.empty() ? bright(light) : std::ranges::any_of(light.moving_values, bright);
}

inline bool holds_group(const std::vector<std::uint8_t>& groups, std::uint32_t group) {
  return groups.empty() || groups[group] != 0;
}

// A dome whose light differs by direction.
inline bool is_image_dome(const Light& light) { return light.kind == LightKind::kDome && light.image; }

// Where a camera light or a dome without an image stands is of no matter, and a mesh light is where its mesh
// is: they need no transform.
inline bool is_placeless(const Light& light) {
  return (light.kind == LightKind::kDome && !light.image) || light.kind == LightKind::kCamera ||
         light.kind == LightKind::kMesh;
}

// Whether it is the same, in the same place of its own, throughout the shutter.
inline bool is_still(const Light& light) {
  const auto moves = [](const LightPortal& portal) { return portal.segments > 0; };
  if (std::ranges::any_of(light.portals, moves)) return false;
  return light.segments == 0 || (is_placeless(light) && light.moving_values.empty());
}

}  // namespace msbvh
