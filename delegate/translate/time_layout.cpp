#include "delegate/translate/time_layout.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace msbvh::translate {
namespace {

// Stretches between breakpoints, with an unused one at each jump.
std::vector<LayoutSegment> stretches(std::span<const Breakpoint> breakpoints) {
  std::vector<LayoutSegment> result;
  double begin = 0.0;
  for (const Breakpoint& breakpoint : breakpoints) {
    result.push_back({begin, breakpoint.time01});
    if (breakpoint.jump) result.push_back({breakpoint.time01, breakpoint.after01, false});
    begin = breakpoint.after01;
  }
  result.push_back({begin, 1.0});
  return result;
}

// Splits the longest until there are `count`: a power of two of segments is what tracks have.
void split_longest(std::vector<LayoutSegment>& segments, std::size_t count) {
  const auto length = [](const LayoutSegment& s) { return s.end01 - s.begin01; };
  while (segments.size() < count) {
    const auto longest = std::ranges::max_element(segments, {}, length);
    const LayoutSegment whole = *longest;
    longest->end01 = whole.middle();
    segments.insert(longest + 1, {whole.middle(), whole.end01});
  }
}

std::vector<LayoutSegment> split_evenly(const std::vector<LayoutSegment>& segments, std::uint32_t split) {
  const std::uint32_t parts = 1u << split;
  std::vector<LayoutSegment> result;
  for (const LayoutSegment& s : segments) {
    for (std::uint32_t i = 0; i < parts; ++i) {
      result.push_back({s.at(double(i) / parts), s.at(double(i + 1) / parts), s.used});
    }
  }
  return result;
}

}  // namespace

std::optional<TimeLayout> TimeLayout::with_breakpoints(std::span<const Breakpoint> breakpoints,
                                                       std::uint32_t split, std::uint32_t max_segments) {
  std::vector<LayoutSegment> segments = stretches(breakpoints);
  const std::size_t count = std::bit_ceil(segments.size());
  if ((count << split) > max_segments) return std::nullopt;
  split_longest(segments, count);
  segments = split_evenly(segments, split);
  TimeLayout layout(std::uint32_t(segments.size()));
  layout.uneven_ = std::move(segments);
  return layout;
}

TimeLayout TimeLayout::repeating(double period01, std::uint32_t split) {
  TimeLayout layout(1u << split);
  layout.uneven_ = split_evenly({{0.0, period01}}, split);
  layout.period01_ = period01;
  return layout;
}

LayoutSegment TimeLayout::segment(std::uint32_t i) const {
  if (!is_even()) return uneven_[i];
  if (segments_ == 0) return {0.0, 1.0};
  return {double(i) / segments_, double(i + 1) / segments_};
}

TimeLayout::Place TimeLayout::place(double local01) const {
  if (is_even()) return {local01, {0.0, 1.0}};
  const double scaled = local01 * segments_;
  std::uint32_t i = std::min(std::uint32_t(scaled), segments_ - 1);
  double w = scaled - i;
  if (!uneven_[i].used && w == 0.0) {  // a key that ends the piece before a jump
    --i;
    w = 1.0;
  }
  return {uneven_[i].at(w), uneven_[i]};
}

namespace {

// A piece for every period; the last one ends where the shutter closes.
TimeRemap repeating_time_remap(double period01) {
  TimeRemap time_remap;
  const double periods = 1.0 / period01;
  const auto whole = std::uint32_t(std::ceil(periods - kSameTime * periods));
  for (std::uint32_t i = 0; i < whole; ++i) {
    const float to = i + 1 < whole ? 1.0f : std::min(1.0f, float(periods - i));
    time_remap.pieces.push_back({float(i * period01), 0.0f, to});
  }
  return time_remap;
}

}  // namespace

TimeRemap TimeLayout::time_remap() const {
  if (repeats()) return repeating_time_remap(period01_);
  TimeRemap time_remap;
  for (std::uint32_t i = 0; !is_even() && i < segments_; ++i) {
    const LayoutSegment& s = uneven_[i];
    if (!s.used) continue;
    const auto begin = static_cast<float>(s.begin01);
    // The one before is shorter than time resolves: a step.
    if (!time_remap.pieces.empty() && begin <= time_remap.pieces.back().begin) time_remap.pieces.pop_back();
    time_remap.pieces.push_back({begin, float(i) / float(segments_), float(i + 1) / float(segments_)});
  }
  return time_remap;
}

TimeRemap with_visibility(const TimeRemap& time_remap, std::span<const VisibleInterval> visible) {
  std::vector<float> begins{0.0f};
  for (const TimeRemapPiece& piece : time_remap.pieces) begins.push_back(piece.begin);
  for (const VisibleInterval& v : visible) {
    begins.push_back(std::clamp(float(v.begin01), 0.0f, 1.0f));
    begins.push_back(std::clamp(float(v.end01), 0.0f, 1.0f));
  }
  std::ranges::sort(begins);
  begins.erase(std::ranges::unique(begins).begin(), begins.end());
  if (begins.size() > 1 && begins.back() == 1.0f) begins.pop_back();  // u = 1 belongs to the piece before
  // Local times on both sides of a boundary, which is inside of one of the time remap's pieces.
  const auto local = [&](float u, std::size_t piece) {
    if (time_remap.is_shutter()) return u;
    const TimeRemapPiece& p = time_remap.pieces[piece];
    const double length = time_remap.end_of(piece) - p.begin;
    const double w = length > 0.0 ? (double(u) - p.begin) / length : 0.0;
    return float((1.0 - w) * p.from + w * p.to);
  };
  TimeRemap result;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const float begin = begins[i], end = i + 1 < begins.size() ? begins[i + 1] : 1.0f;
    const std::size_t piece = time_remap.is_shutter() ? 0 : time_remap.piece_at(begin);
    const double middle = 0.5 * (double(begin) + double(end));
    const bool shown = std::ranges::any_of(
        visible, [&](const VisibleInterval& v) { return v.begin01 <= middle && middle < v.end01; });
    result.pieces.push_back({begin, local(begin, piece), local(end, piece), shown});
  }
  return result;
}

std::vector<Breakpoint> normalized_breakpoints(std::vector<Breakpoint> breakpoints) {
  std::ranges::sort(breakpoints, {}, &Breakpoint::time01);
  std::vector<Breakpoint> result;
  for (const Breakpoint& breakpoint : breakpoints) {
    if (!(breakpoint.time01 > kSameTime && breakpoint.time01 < 1.0 - kSameTime)) continue;
    const double distance = result.empty() ? 1.0 : breakpoint.time01 - result.back().time01;
    if (distance <= kTimeResolution) {
      Breakpoint& last = result.back();
      last.jump = last.jump || breakpoint.jump || distance > kSameTime;
      last.after01 = std::max(last.after01, breakpoint.after01);
    } else {
      result.push_back(breakpoint);
    }
  }
  return result;
}

}  // namespace msbvh::translate
