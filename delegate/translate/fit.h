// The search for the fewest segments.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

struct FitSettings {
  double tolerance;  // largest deviation allowed between the track and the samples
  std::uint32_t max_segments;
};

struct Fit {
  std::uint32_t segments = 0;
  double error = 0.0;  // largest deviation found, in the unit of the tolerance
};

// Values that a camera cannot tell from still ones: what composing transforms that cancel leaves over.
inline constexpr double kStillShare = 0.01;  // of the tolerance

// `error(segments, limit)` returns the largest deviation of a track with so many segments; it may return
// early with any value above `limit`. Tries 0 (still, at kStillShare of the tolerance), 1, 2, 4 ...
// max_segments, and takes the first that is within the tolerance, else the last.
template <typename ErrorFunction>
Fit fewest_segments(const FitSettings& settings, const ErrorFunction& error) {
  const double still = error(0u, kStillShare * settings.tolerance);
  if (still <= kStillShare * settings.tolerance) return {0, still};
  for (std::uint32_t segments = 1; segments < settings.max_segments; segments *= 2) {
    const double deviation = error(segments, settings.tolerance);
    if (deviation <= settings.tolerance) return {segments, deviation};
  }
  return {settings.max_segments, error(settings.max_segments, std::numeric_limits<double>::infinity())};
}

// Warns where not even the last track was within the tolerance. `what` moves, with `remark` on why or none.
inline void report_fit(const Fit& fit, double tolerance_pixels, const std::string& attribute,
                       const char* what, const char* remark, PrimLog& log) {
  if (fit.error <= tolerance_pixels) return;
  log.warn(attribute, message(what, " deviates by ", fit.error, " pixels at ", fit.segments, " segments",
                              remark, "; expected at most ", tolerance_pixels));
}

}  // namespace msbvh::translate
