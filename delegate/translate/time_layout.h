// How a track's segments lie in the shutter, and which layouts a fit may choose from.
//
// Even layouts have keys at i / 2^k. A layout with breakpoints puts keys at those, at whatever times
// that is, and leaves out the segment between two keys where it jumps; it comes with the time remap that the
// renderer then needs (core/motion/time_remap.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/motion/time_remap.h"
#include "core/motion/track.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// A time within (0, 1) at which motion changes its direction or, `jump`, its place. What follows a jump
// starts at `after01`, closer to it than a ray's time can tell apart.
struct Breakpoint {
  Breakpoint(double time, bool jumps = false) : time01(time), after01(time), jump(jumps) {}

  double time01, after01;
  bool jump;
};

// The shutter time that a segment covers. Unused ones lie between two pieces; no ray comes there.
struct LayoutSegment {
  double begin01, end01;
  bool used = true;

  double at(double w) const { return (1.0 - w) * begin01 + w * end01; }
  double middle() const { return at(0.5); }
};

class TimeLayout {
 public:
  static TimeLayout even(std::uint32_t segments) { return TimeLayout(segments); }
  // Each stretch between breakpoints takes 2^split segments. Nothing if that takes more than `max_segments`.
  static std::optional<TimeLayout> with_breakpoints(std::span<const Breakpoint> breakpoints,
                                                    std::uint32_t split, std::uint32_t max_segments);
  // One period of a motion that repeats, on 2^split segments; the time remap runs through it again and again.
  // `period01` as is_period() has it.
  static TimeLayout repeating(double period01, std::uint32_t split);

  std::uint32_t segments() const { return segments_; }
  bool is_even() const { return uneven_.empty(); }
  // 1 for what does not repeat.
  double period01() const { return period01_; }
  bool repeats() const { return period01_ < 1.0; }
  LayoutSegment segment(std::uint32_t i) const;
  // Shutter time of a place of the track's own time, and the segment whose side of a jump it is on.
  struct Place {
    double time01;
    LayoutSegment segment;
  };
  Place place(double local01) const;
  // The shutter's own for even layouts.
  TimeRemap time_remap() const;

 private:
  explicit TimeLayout(std::uint32_t segments) : segments_(segments) {}

  std::uint32_t segments_;
  std::vector<LayoutSegment> uneven_;  // of them; empty: even
  double period01_ = 1.0;
};

// Periods that are worth a track of their own, as shares of the shutter. Longer ones repeat less than twice.
// Shorter ones belong to slips of a unit: no frame shows the difference, and a piece for each of so many
// repetitions takes memory and ends at times that single precision cannot tell apart.
inline constexpr double kMostRepeats = 512.0;
inline constexpr double kShortestPeriod01 = 1.0 / kMostRepeats, kLongestPeriod01 = 0.5;
constexpr bool is_period(double period01) {
  return period01 >= kShortestPeriod01 && period01 <= kLongestPeriod01;
}

// `time_remap`, hidden outside the intervals.
TimeRemap with_visibility(const TimeRemap& time_remap, std::span<const VisibleInterval> visible);

// Sorted, within (0, 1). Those within kSameTime of each other are one, those within kTimeResolution of each
// other, which single precision does not tell apart, a jump.
inline constexpr double kSameTime = 1e-12;
inline constexpr double kTimeResolution = 0x1p-24;
std::vector<Breakpoint> normalized_breakpoints(std::vector<Breakpoint> breakpoints);

}  // namespace msbvh::translate
