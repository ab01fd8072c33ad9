// What the gate of a scene says of a part that does not hold: the part, the attribute, found and expected.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/vec.h"
#include "core/motion/track.h"
#include "core/scene/camera.h"

namespace msbvh::gate {

inline void expect(bool holds, const std::string& part, const std::string& attribute,
                   const std::string& found, const std::string& expected) {
  if (!holds) throw Error(part + ": " + attribute + ": found " + found + "; expected " + expected);
}

using msbvh::is_finite;
inline bool is_finite(float x) { return std::isfinite(x); }
inline bool is_finite(const ScreenWindow& w) {
  return is_finite(w.left) && is_finite(w.right) && is_finite(w.bottom) && is_finite(w.top);
}

inline bool is_finite(const ClipRange& clip) { return is_finite(clip.near_clip) && is_finite(clip.far_clip); }
inline bool is_finite(const Lens& lens) { return is_finite(lens.radius) && is_finite(lens.focus_distance); }

template <typename T>
void expect_all_finite(const std::vector<T>& values, const std::string& part, const std::string& attribute) {
  const auto bad = std::find_if(values.begin(), values.end(), [](const T& v) { return !is_finite(v); });
  expect(bad == values.end(), part, attribute,
         "NaN or infinity in element " + std::to_string(bad - values.begin()), "finite values");
}

inline void expect_segments(std::uint32_t segments, const std::string& part, const std::string& attribute) {
  expect(is_valid_segment_count(segments), part, attribute, std::to_string(segments) + " segments",
         "0 or a power of two up to " + std::to_string(kMaxSegments));
}

template <typename T>
void expect_track(const std::vector<T>& keys, std::uint32_t segments, const std::string& part,
                  const std::string& attribute) {
  expect_segments(segments, part, attribute);
  expect(keys.size() == key_count(segments), part, attribute, std::to_string(keys.size()) + " keys",
         std::to_string(key_count(segments)));
  expect_all_finite(keys, part, attribute);
}

inline void expect_index(std::size_t index, std::size_t size, const std::string& part,
                         const std::string& attribute) {
  expect(index < size, part, attribute, "index " + std::to_string(index),
         "less than " + std::to_string(size));
}

inline void expect_size(float size, const std::string& part, const std::string& attribute) {
  expect(is_finite(size) && size >= 0.0f, part, attribute, std::to_string(size),
         "a finite number of at least 0");
}

}  // namespace msbvh::gate
