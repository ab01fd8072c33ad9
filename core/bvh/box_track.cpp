#include "core/bvh/box_track.h"

#include <algorithm>
#include <utility>

#include "core/bvh/key_bounds.h"

namespace msbvh {
namespace {

// How far `inner` reaches out of `outer`, side by side; never negative.
struct Excess {
  Vec3f lo{0, 0, 0}, hi{0, 0, 0};

  void grow(const Box3f& inner, const Box3f& outer) {
    lo = max(lo, outer.lo - inner.lo);
    hi = max(hi, inner.hi - outer.hi);
  }
  void grow(const Excess& e) {
    lo = max(lo, e.lo);
    hi = max(hi, e.hi);
  }
};

// One slot in half as many segments.
void halve(std::span<const Box3f> fine, std::span<Box3f> coarse) {
  if (coarse.size() == 1) {  // two keys: at rest in the box around both
    coarse[0] = fine[0];
    coarse[0].grow(fine[1]);
    coarse[0] = padded(coarse[0], kRekeyPad * largest_coordinate(coarse[0]));
    return;
  }
  Excess before;
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    Excess excess = before;
    before = {};
    float size = largest_coordinate(fine[2 * k]);
    if (k > 0) size = std::max(size, largest_coordinate(fine[2 * k - 2]));
    if (k + 1 < coarse.size()) {
      before.grow(fine[2 * k + 1], lerp(fine[2 * k], fine[2 * k + 2], 0.5f));
      size = std::max(size, largest_coordinate(fine[2 * k + 2]));
    }
    excess.grow(before);
    coarse[k] = padded({fine[2 * k].lo - excess.lo, fine[2 * k].hi + excess.hi}, kRekeyPad * size);
  }
}

double area_of(const SlotTracks& slots) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < slots.count; ++i) sum += mean_half_area(slots.slot(i), slots.form);
  return sum;
}

BoxTrack grown_together(const SlotTracks& slots, const TrackForm& form) {
  BoxTrack all(form);
  for (std::uint32_t i = 0; i < slots.count; ++i) grow_track(all.controls, form, slots.slot(i), slots.form);
  return all;
}

}  // namespace

SlotTracks in_fewest_segments(SlotTracks slots) {
  if (!slots.form.moving() || slots.form.degree > 1) return slots;
  const double allowed = kCoarserArea * area_of(slots);
  while (slots.form.moving()) {
    const std::uint32_t segments = slots.form.segments / 2;
    SlotTracks coarse({segments, 1}, slots.count);
    for (std::uint32_t i = 0; i < slots.count; ++i) halve(slots.slot(i), coarse.slot(i));
    if (!(area_of(coarse) <= allowed)) break;
    slots = std::move(coarse);
  }
  return slots;
}

BoxTrack union_of(const SlotTracks& slots, std::uint32_t max_segments) {
  BoxTrack all = grown_together(slots, slots.form);
  const std::uint32_t segments = 2 * slots.form.segments;
  if (!slots.form.moving() || slots.form.degree > 1 || segments > max_segments) return all;
  BoxTrack finer = grown_together(slots, {segments, 1});
  const bool pays =
      mean_half_area(all.controls, all.form) > kFinerArea * mean_half_area(finer.controls, finer.form);
  return pays ? std::move(finer) : std::move(all);
}

}  // namespace msbvh
