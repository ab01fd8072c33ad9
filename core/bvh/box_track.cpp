#include "core/bvh/box_track.h"

#include <utility>

#include "core/bvh/key_bounds.h"
#include "core/bvh/track_area.h"

namespace msbvh {
namespace {

double area_of(const SlotTracks& slots) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < slots.count; ++i) sum += slots.area[i];
  return sum;
}

BoxTrack grown_together(const SlotTracks& slots, const TrackForm& form) {
  BoxTrack all(form);
  for (std::uint32_t i = 0; i < slots.count; ++i) grow_track(all.controls, form, slots.slot(i), slots.form);
  return all;
}

}  // namespace

void SlotTracks::measure() {
  for (std::uint32_t i = 0; i < count; ++i) area[i] = mean_half_area(slot(i), form);
}

SlotTracks in_fewest_segments(SlotTracks slots) {
  if (!slots.form.moving() || slots.form.degree > 1) return slots;
  const double allowed = kCoarserArea * area_of(slots);
  while (slots.form.moving()) {
    const std::uint32_t segments = slots.form.segments / 2;
    SlotTracks coarse({segments, 1}, slots.count);
    for (std::uint32_t i = 0; i < slots.count; ++i) halve_segments(slots.slot(i), coarse.slot(i));
    coarse.measure();
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
