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

// By what they cost, the cheapest first: control points (bytes, in the end), twice where it takes a time
// remap and with it a level of instancing; at equal cost the lower degree. Motion that jumps has layouts with
// breakpoints only, as long as there are fewer breakpoints than a track has keys. `periods01`: after which
// the motion may repeat; whether it does is for the caller to test.
std::vector<Candidate> candidates(std::span<const Breakpoint> breakpoints, const FitSettings& settings,
                                  std::span<const double> periods01 = {});

struct CandidateFit {
  std::size_t index = 0;  // among the candidates
  double error = 0.0;     // the largest deviation at one instant
};

// Tests find at least this share of the largest deviation of a track that is close to the stage.
inline constexpr double kFoundShare = 0.97;

// The first candidate within the tolerance; where none is, the one whose blur is closest (blur.h). `error(i,
// limit)` is the largest deviation at an instant, or any value above the limit; `blur(i)` how far the blur is
// off.
template <typename ErrorFunction, typename BlurFunction>
CandidateFit cheapest_candidate(std::span<const Candidate> tracks, double tolerance,
                                const ErrorFunction& error, const BlurFunction& blur) {
  const double limit = kFoundShare * tolerance;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const double largest = error(i, limit);
    if (largest <= limit) return {i, largest};
  }
  std::uint32_t most = 0;
  for (const Candidate& track : tracks) {
    if (!track.layout.repeats()) most = std::max(most, track.layout.segments());
  }
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> finest;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    // With fewer segments of the same kind the blur is no closer; a motion that did not repeat does not now.
    if (!tracks[i].layout.repeats() && 2 * tracks[i].layout.segments() > most) finest.push_back(i);
  }
  std::size_t best = finest.front();
  double least = kInfinite;
  for (const std::size_t i : finest) {
    const double off = finest.size() == 1 ? 0.0 : blur(i);
    if (off < least) {
      best = i;
      least = off;
    }
  }
  return {best, error(best, kInfinite)};
}

// Where a segment's track is compared with the truth beside the breakpoints in it: places at which
// interpolation at fit_nodes() errs most.
std::span<const double> test_places(std::uint32_t degree);
// Between two neighbours of the times that a motion is sampled at it turns by a small part of a turn only. So
// nothing that repeats hides from a test at all of them. A segment with no more than so many of them inside
// has enough with its test places.
inline constexpr std::size_t kFewSamples = 4;
// All test times of a segment: its test places, the breakpoints inside with the middles between them, and
// those of `dense01` (increasing) inside.
std::vector<double> test_times01(const LayoutSegment& segment, std::uint32_t degree,
                                 std::span<const Breakpoint> breakpoints, std::span<const double> dense01);
// Those of increasing times that lie inside a segment; empty where they are few.
std::span<const double> dense_inside(const LayoutSegment& segment, std::span<const double> dense01);

// What helps where no allowed track follows a motion.
inline const char* advice(const TrackChoice& choice) {
  if (choice.segments != 0) return "more --segments help, or none given";
  if (choice.min_degree > 1 || choice.max_degree < kMaxDegree) return "--interpolation auto may help";
  return "no track has more segments; a shorter shutter or a larger --motion-tolerance helps";
}

// Warns where not even the best track was within the tolerance. `what` moves.
inline void report_fit(const Fit& fit, const FitSettings& settings, const std::string& attribute,
                       const char* what, PrimLog& log) {
  if (fit.error <= settings.tolerance) return;
  log.warn(attribute,
           message(what, " deviates by up to ", fit.error, " pixels at ", fit.segments,
                   " segments; expected at most ", settings.tolerance, "; ", advice(settings.choice)));
}

}  // namespace msbvh::translate
