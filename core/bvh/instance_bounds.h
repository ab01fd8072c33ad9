// Boxes of moving instances of moving objects, in the outer tree's space.
#pragma once

#include <span>

#include "core/base/affine.h"
#include "core/base/box.h"
#include "core/build/reference.h"

namespace msbvh {

// Bounds M(u) x(u) for all x(u) in the object's box, at the finer of both grids. The matrix *elements* and
// the box are linear in time on a segment, so a corner's path is quadratic: its ends, lifted by the sagitta
// of its control polygon, bound it linearly. The result is padded by the error of bringing a ray into the
// object's space in single precision.
InstanceBounds bound_instance(std::span<const Affine3f> matrix_keys, std::uint32_t matrix_segments,
                              std::span<const Box3f> object_keys, std::uint32_t object_segments);

// Relative to |M| |x| + |t|, by component: the interpolated matrix errs by kLerpError, the ray's transformed
// origin and direction by one rounding of the object-space coordinate each, and the box by kLerpError in
// flight.
inline constexpr double kInstancePad = 4.0 * 0x1p-22;

}  // namespace msbvh
