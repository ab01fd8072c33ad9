// Affine maps that move along a track: the matrix *elements* are interpolated (paper, section on instances).
#pragma once

#include <span>

#include "core/base/affine.h"
#include "core/base/lerp.h"
#include "core/motion/track.h"

namespace msbvh {

// `keys` holds key_count(segments) maps.
inline Affine3f evaluate(std::span<const Affine3f> keys, std::uint32_t segments, float u) {
  const SegmentTime at = locate(u, segments);
  return segments == 0 ? keys[0] : lerp(keys[at.key], keys[at.key + 1], at.w);
}

}  // namespace msbvh
