// The rays that both sides trace. Times are random in [0, 1] for all of them: the worst case for caches.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/scene_classes.h"
#include "core/base/box.h"
#include "core/trace/ray.h"
#include "core/trace/tracer.h"

namespace msbvh::bench {

enum class RayKind : std::uint8_t {
  kPrimary,  // through a square image of the scene's camera, in tiles of 8 x 8
  kShadow,   // from where primary rays hit to a small light above the scene, or in it: any hit
  kRandom    // between two random points of the scene's box and on: incoherent
};
inline constexpr RayKind kRayKinds[] = {RayKind::kPrimary, RayKind::kShadow, RayKind::kRandom};
const char* ray_kind_name(RayKind kind);

// About `count` rays; empty where there are none (shadow rays of an image that shows nothing).
std::vector<Ray> make_rays(RayKind kind, const Scene& scene, const Box3f& bounds, const Tracer& tracer,
                           std::size_t count, std::uint32_t seed);
// From the ball in every direction.
std::vector<Ray> inside_rays(const Interior& interior, std::size_t count, std::uint32_t seed);

}  // namespace msbvh::bench
