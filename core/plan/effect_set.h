// The effects that a scene may call for, and sets of them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace msbvh {

enum class Effect : std::uint32_t {
  kDeformingKeys = 1u << 0,    // a geometry has more than one key
  kInstances = 1u << 1,        // a two-level hierarchy is needed
  kMovingInstances = 1u << 2,  // an instance has more than one key
  kCameraMotion = 1u << 3,
  kMovingLights = 1u << 4,
  kOpacity = 1u << 5,  // some surface lets light through
  kAreaLights = 1u << 6,
  kDomeLight = 1u << 7,
  kIndirectLight = 1u << 8,
  kLens = 1u << 9,               // depth of field
  kPolynomialMotion = 1u << 10,  // a geometry or an instance moves on curves of degree 2 or 3
  kTimeRemaps = 1u << 11,        // breakpoints, jumps or visibility at times between even keys
  kAovs = 1u << 12,              // more than colour and alpha is asked for
  kCurves = 1u << 13,            // leaves of their own
  kPoints = 1u << 14,            // likewise
  kDisplacement = 1u << 15,      // of surfaces along their normals
  kSubdivision = 1u << 16,       // a cage's limit surface is drawn, as triangles
  kSpecular = 1u << 17,          // some surface reflects otherwise than diffusely
  kTextures = 1u << 18,          // a material reads a texture, or a primvar other than the display ones
  kLightControls = 1u << 19,     // shaping, multipliers, shadow settings, links, images of rects
  kImageDome = 1u << 20,         // a dome whose light differs by direction
  kRefraction = 1u << 21,        // what is transparent bends light
  kFibre = 1u << 22              // curves that scatter light as hair does
};

constexpr std::size_t kEffectCount = 23;
constexpr Effect effect_at(std::size_t index) { return static_cast<Effect>(1u << index); }

// A set of effects; usable as a template argument.
struct EffectSet {
  std::uint32_t bits = 0;
  constexpr bool has(Effect e) const { return (bits & static_cast<std::uint32_t>(e)) != 0; }
  constexpr EffectSet with(Effect e) const { return {bits | static_cast<std::uint32_t>(e)}; }
  constexpr EffectSet without(Effect e) const { return {bits & ~static_cast<std::uint32_t>(e)}; }
  constexpr bool operator==(const EffectSet&) const = default;
};

}  // namespace msbvh
