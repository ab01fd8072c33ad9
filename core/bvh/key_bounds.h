// Boxes at the controls of a track (its keys, where it is linear): steps 2 to 4 of the paper's construction
// (sections 3.2, 3.3) for one reference or one set of children. For Bezier tracks these are control boxes:
// the curve of a box whose controls enclose a vertex's controls encloses the vertex (core/motion/bezier.h).
#pragma once

#include <span>

#include "core/base/box.h"
#include "core/base/lerp.h"
#include "core/build/reference.h"
#include "core/motion/track.h"

namespace msbvh {

// A track of boxes rewritten in a finer form (more segments, a higher degree, or moving at all), gets padded
// by this share of its largest coordinate for each degree: evaluating either form errs by at most kLerpError
// a degree, and the new controls are rounded.
inline constexpr float kRekeyPad = 4.0f * kLerpError;

// A fragment's corner is a weighted sum of vertices. The vertices in flight, and the box in flight, err by
// kLerpError each for a degree (core/base/lerp.h); the sum itself is made in double and rounded outwards. 4
// units of 2^-22 are 8 machine epsilons.
inline constexpr float kFragmentPad = 4.0f * kLerpError;

float largest_coordinate(const Box3f& box);  // by magnitude
Box3f padded(const Box3f& box, float pad);

// Grows `out` (form.controls() boxes) by `track` (track_form.controls() boxes); `form` must be a
// common_form() of both. In the same form nothing is padded: interpolation is monotone.
void grow_track(std::span<Box3f> out, const TrackForm& form, std::span<const Box3f> track,
                const TrackForm& track_form);

// A linear track in half as many segments (1 to still): a segment of `coarse` encloses the two of `fine` that
// it stands for, its ends moved out by what they bulge beyond its chord.
void halve_segments(std::span<const Box3f> fine, std::span<Box3f> coarse);

// Grows `out` by the boxes of what the reference stands for, at every control: a whole triangle's vertices, a
// fragment's moved corners, an instance's bounds. Where primitives are swept or sliced, `form` is one that
// node_form_of() speaks of, and out is grown by the union of all boxes, or by what lies in the slice.
void grow_by_reference(std::span<Box3f> out, const TrackForm& form, const Primitives& primitives,
                       const Reference& reference);

}  // namespace msbvh
