// A moving box, and how few keys bound it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/box.h"
#include "core/bvh/layout.h"
#include "core/motion/track.h"

namespace msbvh {

// The box at the controls of a track.
struct BoxTrack {
  TrackForm form;
  std::vector<Box3f> controls;  // form.controls()

  BoxTrack() = default;
  explicit BoxTrack(const TrackForm& form) : form(form), controls(form.controls()) {}
};

// The boxes of a node's children, in one form.
struct SlotTracks {
  TrackForm form;
  std::vector<Box3f> controls;  // [slot][control]
  std::uint32_t count;
  std::array<double, kWidth> area{};  // mean_half_area() of each, once measure() has been called

  SlotTracks(const TrackForm& form, std::uint32_t count)
      : form(form), controls(std::size_t(count) * form.controls()), count(count) {}
  std::span<Box3f> slot(std::uint32_t i) {
    return {controls.data() + std::size_t(i) * form.controls(), form.controls()};
  }
  std::span<const Box3f> slot(std::uint32_t i) const {
    return {controls.data() + std::size_t(i) * form.controls(), form.controls()};
  }
  void measure();
};

// How much larger, summed over the slots and averaged over the shutter, the boxes may become for half as many
// segments. More: fewer bytes and more nodes a ray.
inline constexpr double kCoarserArea = 1.04;
// How much smaller a node's box, averaged over the shutter, must become for twice as many.
inline constexpr double kFinerArea = 1.05;

// The slots in as few segments as bound them about as well: halved as long as kCoarserArea allows. A segment
// of the result encloses the finer ones that it stands for: its ends are moved out by what they bulge beyond
// its chord. Curves (degree > 1) stay as they are. Slots go in and come out measured.
SlotTracks in_fewest_segments(SlotTracks slots);

// The box around all slots. Between keys slots that move differently are closer together than at them: where
// that is worth kFinerArea and allowed by `max_segments`, the union has a key in the middle of each segment.
BoxTrack union_of(const SlotTracks& slots, std::uint32_t max_segments);

}  // namespace msbvh
