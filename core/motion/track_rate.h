// How fast tracks change: value and derivative together, in double precision.
//
// A track may turn at its keys, and a time remap at its breakpoints: there it has two rates, that of what
// comes before and that of what comes after. Where it jumps, the jump is no rate.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/motion/bezier.h"
#include "core/motion/time_remap.h"
#include "core/motion/track.h"

namespace msbvh {

enum class Side : std::uint8_t { kBefore, kAfter };

template <typename T>
struct Moving {
  T value{};
  T rate{};  // per unit of time; of what time, the function says that returns it
};

// The segment that ends at `u` where `side` is kBefore and u is a key; else as locate().
constexpr SegmentTime locate(float u, std::uint32_t segments, Side side) {
  const SegmentTime at = locate(u, segments);
  return side == Side::kBefore && at.w == 0.0f && at.key > 0 ? SegmentTime{at.key - 1, 1.0f} : at;
}

// `control(i)` gives control i of the whole track, of a type that lerp() takes with a double. Per unit of the
// track's time.
template <typename Controls>
auto moving_value(const Controls& control, const TrackForm& form, float u, Side side)
    -> Moving<decltype(control(0))> {
  if (!form.moving()) return {control(0), {}};
  const SegmentTime at = locate(u, form.segments, side);
  const std::uint32_t first = at.key * form.degree;
  const double w = at.w;
  const auto own = [&](std::uint32_t i) { return control(first + i); };
  const auto leg = [&](std::uint32_t i) { return own(i + 1) - own(i); };
  const double scale = double(form.segments) * form.degree;
  const auto value = bezier(own, form.degree, w);
  return {value, (form.degree == 1 ? leg(0) : bezier(leg, form.degree - 1, w)) * scale};
}

// A remap's local time, and its rate per unit of the shutter.
inline Moving<double> moving_time(const TimeRemap& remap, float u, Side side) {
  if (remap.is_shutter()) return {double(u), 1.0};
  std::size_t i = remap.piece_at(u);
  if (side == Side::kBefore && i > 0 && remap.pieces[i].begin == u) --i;
  const TimeRemapPiece& piece = remap.pieces[i];
  const double length = remap.end_of(i) - double(piece.begin), span = double(piece.to) - double(piece.from);
  if (!(length > 0.0)) return {double(piece.from), 0.0};
  return {double(piece.from) + span * (double(u) - double(piece.begin)) / length, span / length};
}

}  // namespace msbvh
