// What a parent says that bounds a child, for verify().
#pragma once

#include <vector>

#include "core/base/box.h"
#include "core/motion/bezier.h"

namespace msbvh {

// A track of boxes; in the time of its slice, where that is not the whole shutter.
struct Slot {
  TrackForm form;
  std::vector<Box3f> controls;
  TimeSlice slice = {};

  Box3f at(float u) const {
    const SegmentTime t =
        slice.whole() || !form.moving() ? locate(u, form.segments) : SegmentTime{0, slice.share(u)};
    return track_value(controls.data(), form, t.key, t.w);
  }
};

}  // namespace msbvh
