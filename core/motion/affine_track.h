// Affine maps that move along a track: the matrix *elements* are interpolated (paper, section on instances).
#pragma once

#include <span>

#include "core/base/affine.h"
#include "core/base/lerp.h"
#include "core/motion/bezier.h"
#include "core/motion/track.h"

namespace msbvh {

// `controls` holds form.controls() maps.
inline Affine3f evaluate(std::span<const Affine3f> controls, const TrackForm& form, float u) {
  const SegmentTime at = locate(u, form.segments);
  return track_value(controls.data(), form, at.key, at.w);
}
inline Affine3f evaluate(std::span<const Affine3f> keys, std::uint32_t segments, float u) {
  return evaluate(keys, TrackForm{segments, 1}, u);
}

}  // namespace msbvh
