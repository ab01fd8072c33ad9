// Boxes of moving instances of moving objects, in the outer tree's space and time.
#pragma once

#include <span>

#include "core/base/affine.h"
#include "core/base/box.h"
#include "core/build/reference.h"
#include "core/motion/time_remap.h"
#include "core/motion/track.h"

namespace msbvh {

// A track under a time remap. Borrows.
template <typename T>
struct RemappedTrack {
  std::span<const T> controls;
  TrackForm form;
  const TimeRemap* time_remap = nullptr;  // null: the shutter's own time
};

// Bounds M(u) x(u) for all x(u) in the object's box.
//
// Without time remaps: where only one of both moves, the products of its controls with the other are the
// controls of a box track of the same form. Where both move, a corner's path is a Bezier curve of the
// degrees' sum on the finer of both grids: its ends, lifted by how far the control polygon can carry it from
// its chord, bound it linearly. With a time remap the boxes are those of all controls in force within each of
// kRemappedSegments parts of the shutter. The result is padded by the error of bringing a ray into the
// object's space in single precision. Empty controls for an object without a box.
InstanceBounds bound_instance(const RemappedTrack<Affine3f>& transform, const RemappedTrack<Box3f>& object);

inline constexpr std::uint32_t kRemappedSegments = 16;

// Relative to |M| |x| + |t|, by component and for each degree: the interpolated matrix errs by kLerpError,
// the ray's transformed origin and direction by one rounding of the object-space coordinate each, and the box
// by kLerpError in flight.
inline constexpr double kInstancePad = 4.0 * 0x1p-22;

}  // namespace msbvh
