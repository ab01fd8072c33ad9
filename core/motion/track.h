// Time inside the shutter, and tracks over it.
//
// A ray's time u in [0, 1] spans the open shutter: u = 0 is shutter:open, u = 1 is shutter:close. A track has
// `segments` = 0 (still, one key) or 2^k segments with keys at i / 2^k, k <= 7. Powers of two nest, so tracks
// of different k live in one tree. Segments are half-open [i, i + 1) / 2^k; u = 1 belongs to the last one.
//
// On a segment a track is a Bezier curve of degree 1 (linear between its keys), 2 or 3. Neighbouring segments
// share the control point between them, so that a track holds segments * degree + 1 controls; for degree 1
// the controls are the keys.
#pragma once

#include <cstdint>

namespace msbvh {

inline constexpr std::uint32_t kMaxSegments = 128;
inline constexpr std::uint32_t kMaxDegree = 3;

constexpr bool is_valid_segment_count(std::uint32_t segments) {
  return segments == 0 || ((segments & (segments - 1)) == 0 && segments <= kMaxSegments);
}

// Keys of a track: 1 for a still one.
constexpr std::uint32_t key_count(std::uint32_t segments) { return segments + 1; }

// How a track is stored. Still tracks have degree 1.
struct TrackForm {
  std::uint32_t segments = 0;
  std::uint32_t degree = 1;

  constexpr std::uint32_t controls() const { return segments * degree + 1; }
  constexpr bool moving() const { return segments != 0; }
  constexpr bool operator==(const TrackForm&) const = default;
};

constexpr bool is_valid_form(const TrackForm& form) {
  return is_valid_segment_count(form.segments) && form.degree >= 1 && form.degree <= kMaxDegree &&
         (form.moving() || form.degree == 1);
}

// The least form that both can be rewritten in without loss: segments by subdivision, degree by elevation.
constexpr TrackForm common_form(const TrackForm& a, const TrackForm& b) {
  return {a.segments > b.segments ? a.segments : b.segments, a.degree > b.degree ? a.degree : b.degree};
}

// The part [index, index + 1) / count of the shutter, closed where it is the last; count is a power of two.
struct TimeSlice {
  std::uint32_t index = 0;
  std::uint32_t count = 1;

  constexpr bool whole() const { return count == 1; }
  constexpr bool operator==(const TimeSlice&) const = default;
  // The shutter's time at the share w in [0, 1] of the slice, and back. Exact where w has few digits.
  constexpr float time(float w) const { return (static_cast<float>(index) + w) / static_cast<float>(count); }
  constexpr float share(float u) const { return u * static_cast<float>(count) - static_cast<float>(index); }
};

// Where a time lies in a track: between keys `key` and `key + 1` with weight w in [0, 1] on the second one.
// For a still track: key 0, w = 0; key + 1 must then not be read. The segment's first control is
// key * degree.
struct SegmentTime {
  std::uint32_t key;
  float w;
};

// Exact: u * 2^k and the difference to an integer below it are representable, so tracks of different k see
// the same instant. u must lie in [0, 1].
constexpr SegmentTime locate(float u, std::uint32_t segments) {
  if (segments == 0) return {0, 0.0f};
  const float scaled = u * static_cast<float>(segments);
  const std::uint32_t key = static_cast<std::uint32_t>(scaled);
  if (key >= segments) return {segments - 1, 1.0f};
  return {key, scaled - static_cast<float>(key)};
}

}  // namespace msbvh
