// Scenes of many small meshes: a swarm, a shattered wall, a crowd of parts. Each mesh has a place, a drift
// and a spin of its own.
#pragma once

#include <cstdint>
#include <memory>

#include "core/scene/scene.h"

namespace msbvh::procedural {

// How the meshes come to move.
enum class SmallMotion : std::uint8_t {
  kStill,
  kPoints,  // their points do, in the world's own tree
  kRigid    // each is the one instance of a prototype of its own, as a mesh under a moving transform is
};

struct SmallMeshes {
  const char* name;
  SmallMotion motion = SmallMotion::kStill;
  TrackForm form{1, 1};         // of the meshes that move
  bool mixed_segments = false;  // 1 to 16 of them instead, a mesh its own number
  bool time_remap = false;      // each under a time remap of its own; points then have a prototype as well
};

// `count` meshes of 12 triangles, every fourth of up to 80, which seldom overlap. The same shapes in the same
// places at the shutter's centre for any kind.
std::shared_ptr<const Scene> small_meshes(const SmallMeshes& kind, std::uint32_t count, std::uint64_t seed);

}  // namespace msbvh::procedural
