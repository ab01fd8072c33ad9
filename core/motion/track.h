// Time inside the shutter, and tracks over it.
//
// A ray's time u in [0, 1] spans the open shutter: u = 0 is shutter:open, u = 1 is shutter:close. A track has
// `segments` = 0 (still, one key) or 2^k segments with keys at i / 2^k, k <= 7. Powers of two nest, so tracks
// of different k live in one tree. Segments are half-open [i, i + 1) / 2^k; u = 1 belongs to the last one.
#pragma once

#include <cstdint>

namespace msbvh {

inline constexpr std::uint32_t kMaxSegments = 128;

constexpr bool is_valid_segment_count(std::uint32_t segments) {
  return segments == 0 || ((segments & (segments - 1)) == 0 && segments <= kMaxSegments);
}

// Keys stored for a track: 1 for a still one.
constexpr std::uint32_t key_count(std::uint32_t segments) { return segments + 1; }

// Where a time lies in a track: between keys `key` and `key + 1` with weight w in [0, 1] on the second one.
// For a still track: key 0, w = 0; key + 1 must then not be read.
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
