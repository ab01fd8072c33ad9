// The search for the cheapest track that follows a motion: what may be chosen, in the order of what it costs.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/time_layout.h"

namespace msbvh::translate {

// Which tracks a fit may use.
struct TrackChoice {
  std::uint32_t min_degree = 1, max_degree = 3;
  std::uint32_t segments = 0;  // exactly these for whatever moves; 0: as few as it takes
};

struct FitSettings {
  double tolerance;  // largest deviation allowed between the track and the stage
  std::uint32_t max_segments;
  TrackChoice choice{};
};

struct Fit {
  std::uint32_t segments = 0;
  double error = 0.0;  // largest deviation found, in the unit of the tolerance
};

// Values that a camera cannot tell from still ones: what composing transforms that cancel leaves over.
inline constexpr double kStillShare = 0.01;  // of the tolerance

// For what is kept on linear tracks of even keys whatever it costs: cameras, lights, primvars.
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

// A track that a fit may choose.
struct Candidate {
  TimeLayout layout = TimeLayout::even(1);
  std::uint32_t degree = 1;

  TrackForm form() const { return {layout.segments(), layout.segments() == 0 ? 1 : degree}; }
};

// By what they cost, the cheapest first: control points (bytes, in the end), twice where it takes a clock and
// with it a level of instancing; at equal cost the lower degree. Motion that jumps has layouts with bends
// only, as long as there are fewer bends than a track has keys.
std::vector<Candidate> candidates(std::span<const Bend> bends, const FitSettings& settings);

struct CandidateFit {
  std::size_t index = 0;  // among the candidates
  double error = 0.0;
};

// The first candidate within the tolerance, else the one that strays least. `error(i, limit)` as above.
template <typename ErrorFunction>
CandidateFit cheapest_candidate(std::size_t count, double tolerance, const ErrorFunction& error) {
  CandidateFit best{0, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < count; ++i) {
    const double deviation = error(i, tolerance);
    if (deviation <= tolerance) return {i, deviation};
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double deviation = error(i, best.error);
    if (deviation < best.error) best = {i, deviation};
  }
  return best;
}

// Where a segment's track is compared with the truth beside the bends in it: places at which interpolation at
// fit_nodes() errs most.
std::span<const double> test_places(std::uint32_t degree);
// All such times of a segment: its test places, and the bends inside with the middles between them.
std::vector<double> test_times01(const LayoutSegment& segment, std::uint32_t degree,
                                 std::span<const Bend> bends);

// Warns where not even the last track was within the tolerance. `what` moves, with `remark` on why or none.
inline void report_fit(const Fit& fit, double tolerance_pixels, const std::string& attribute,
                       const char* what, const char* remark, PrimLog& log) {
  if (fit.error <= tolerance_pixels) return;
  log.warn(attribute, message(what, " deviates by ", fit.error, " pixels at ", fit.segments, " segments",
                              remark, "; expected at most ", tolerance_pixels));
}

}  // namespace msbvh::translate
