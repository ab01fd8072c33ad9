// A vertex with a thickness, of which curves and points are made.
#pragma once

#include <type_traits>

#include "core/base/lerp.h"
#include "core/base/vec.h"

namespace msbvh {

// Both move along tracks by the same rule (core/base/lerp.h). 16 bytes: one load.
struct RoundVertex {
  Vec3f p;
  float radius = 0.0f;
  bool operator==(const RoundVertex&) const = default;
};
static_assert(sizeof(RoundVertex) == 16 && std::is_trivially_copyable_v<RoundVertex>);

constexpr RoundVertex lerp(const RoundVertex& a, const RoundVertex& b, float w) {
  return {lerp(a.p, b.p, w), lerp(a.radius, b.radius, w)};
}

}  // namespace msbvh
