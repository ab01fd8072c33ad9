#include "delegate/translate/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace msbvh::translate {
namespace {

struct Priced {
  Candidate candidate;
  std::uint32_t cost;
};

// Keys at even fractions catch these breakpoints by themselves.
bool is_dyadic(const Breakpoint& breakpoint, std::uint32_t segments) {
  const double scaled = breakpoint.time01 * segments;
  return std::abs(scaled - std::round(scaled)) <= 1e-9 * segments;
}

void add_degrees(const TimeLayout& layout, std::uint32_t price, const TrackChoice& choice,
                 std::vector<Priced>& out) {
  for (std::uint32_t degree = choice.min_degree; degree <= choice.max_degree; ++degree) {
    const Candidate candidate{layout, degree};
    out.push_back({candidate, price * candidate.form().controls()});
  }
}

void add_repeating(double period01, const FitSettings& settings, std::vector<Priced>& out) {
  const TrackChoice& choice = settings.choice;
  for (std::uint32_t split = 0; (1u << split) <= settings.max_segments; ++split) {
    if (choice.segments != 0 && choice.segments != 1u << split) continue;
    add_degrees(TimeLayout::repeating(period01, split), 2, choice, out);
  }
}

}  // namespace

std::vector<Candidate> candidates(std::span<const Breakpoint> breakpoints, const FitSettings& settings,
                                  std::span<const double> periods01) {
  const TrackChoice& choice = settings.choice;
  const bool jumps = std::ranges::any_of(breakpoints, &Breakpoint::jump);
  const bool dyadic = !jumps && std::ranges::all_of(breakpoints, [&](const Breakpoint& breakpoint) {
    return is_dyadic(breakpoint, settings.max_segments);
  });
  std::vector<Priced> priced;
  if (!dyadic) {
    for (std::uint32_t split = 0;; ++split) {
      const auto layout = TimeLayout::with_breakpoints(breakpoints, split, settings.max_segments);
      if (!layout) break;
      if (choice.segments == 0 || choice.segments == layout->segments()) {
        add_degrees(*layout, 2, choice, priced);
      }
    }
  }
  if (!jumps || priced.empty()) {
    const std::uint32_t first = choice.segments == 0 ? 1 : choice.segments;
    const std::uint32_t last = choice.segments == 0 ? settings.max_segments : choice.segments;
    for (std::uint32_t segments = first; segments <= last; segments *= 2) {
      add_degrees(TimeLayout::even(segments), 1, choice, priced);
      if (segments == 0) break;
    }
  }
  for (const double period01 : periods01) {
    if (is_period(period01)) add_repeating(period01, settings, priced);
  }
  std::ranges::stable_sort(priced, {}, [](const Priced& p) { return std::pair(p.cost, p.candidate.degree); });
  std::vector<Candidate> result;
  for (Priced& p : priced) result.push_back(std::move(p.candidate));
  if (result.empty()) result.push_back({TimeLayout::even(0), 1});  // max_segments is 0
  return result;
}

std::span<const double> test_places(std::uint32_t degree) {
  static constexpr std::array<double, 3> kLinear{0.5, 0.25, 0.75};
  static constexpr std::array<double, 4> kQuadratic{0.21, 0.79, 0.35, 0.65};
  static constexpr std::array<double, 5> kCubic{0.5, 0.1, 0.9, 0.37, 0.63};
  if (degree == 1) return kLinear;
  return degree == 2 ? std::span<const double>(kQuadratic) : std::span<const double>(kCubic);
}

std::span<const double> dense_inside(const LayoutSegment& segment, std::span<const double> dense01) {
  const auto begin = std::ranges::upper_bound(dense01, segment.begin01 + kSameTime);
  const auto end = std::lower_bound(begin, dense01.end(), segment.end01 - kSameTime);
  const std::span<const double> inside(begin, end);
  return inside.size() > kFewSamples ? inside : std::span<const double>{};
}

std::vector<double> test_times01(const LayoutSegment& segment, std::uint32_t degree,
                                 std::span<const Breakpoint> breakpoints, std::span<const double> dense01) {
  std::vector<double> result;
  if (!segment.used) return result;
  for (const double place : test_places(degree)) result.push_back(segment.at(place));
  double before = segment.begin01;
  bool any = false;
  for (const Breakpoint& breakpoint : breakpoints) {
    if (!(breakpoint.time01 > segment.begin01 + kSameTime && breakpoint.time01 < segment.end01 - kSameTime))
      continue;
    result.push_back(breakpoint.time01);
    result.push_back(0.5 * (before + breakpoint.time01));
    before = breakpoint.time01;
    any = true;
  }
  if (any) result.push_back(0.5 * (before + segment.end01));
  const std::span<const double> dense = dense_inside(segment, dense01);
  result.insert(result.end(), dense.begin(), dense.end());
  return result;
}

}  // namespace msbvh::translate
