// Boxes at keys: steps 2 to 4 of the paper's construction (sections 3.2, 3.3) for one reference or one set of
// children.
#pragma once

#include <span>

#include "core/base/box.h"
#include "core/base/lerp.h"
#include "core/build/reference.h"

namespace msbvh {

// A track of boxes on a coarse grid, read on a finer one (both power-of-two or still), gets padded by this
// share of its largest coordinate: rounding the intermediate key and interpolating on either grid err by at
// most kLerpError each.
inline constexpr float kRekeyPad = 4.0f * kLerpError;

// A fragment's corner is a weighted sum of vertices. The vertices in flight, and the box in flight, err by
// kLerpError each (core/base/lerp.h); the sum itself is made in double and rounded outwards. 4 units of 2^-22
// are 8 machine epsilons.
inline constexpr float kFragmentPad = 4.0f * kLerpError;

// Grows out[0 .. segments] by `track` (key_count(track_segments) boxes). `segments` must be a multiple of
// track_segments, or track_segments be 0. At equal keys nothing is padded: interpolation is monotone.
void grow_keys(std::span<Box3f> out, std::uint32_t segments, std::span<const Box3f> track,
               std::uint32_t track_segments);

// Grows `out` by the boxes of what the reference stands for, at every key: a whole triangle's vertices, a
// fragment's moved corners, an instance's bounds.
void grow_by_reference(std::span<Box3f> out, std::uint32_t segments, const Primitives& primitives,
                       const Reference& reference);

// The area of linearly moving box, averaged over the shutter: quadratic in time on each segment, so
// Simpson's rule is exact. Half areas, as half_area().
double mean_half_area(std::span<const Box3f> keys);

}  // namespace msbvh
