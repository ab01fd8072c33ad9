// Values over the shutter that are no motion. Integers and tokens hold until their next sample, and on a held
// stage everything does: what they select is drawn in parts, each visible for as long as they last.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "delegate/translate/frame/intervals.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Each is a mesh, or a set of instances, of its own.
inline constexpr std::size_t kMostStretches = 32;
// Where holds_between() looks, as shares of the way from one sample to the next.
inline constexpr std::array kProbes{0.3819660, 0.5, 0.7236068};

// Parts of the shutter over which values stay the same.
struct HeldStretch {
  std::size_t first = 0;  // of the times: where the values are met first
  Visibility shown{};     // not given: all of the shutter
};

// Where values that may change at increasing `begins01` are the same, in the order of their first appearance.
// `kinds`: one a time, equal where the values are that hold from there on. None where there would be more
// than kMostStretches.
std::vector<HeldStretch> held_stretches(std::span<const double> begins01, std::span<const std::size_t> kinds);

// The times between which values are linear in parts of the shutter, increasing: their beginnings, an instant
// before each end, and what is authored inside.
std::vector<double> knots_within(std::span<const double> authored01, std::span<const VisibleInterval> shown);

// Of a value that only a host can evaluate, at `times01` and between them: whether it jumps from one to the
// next and holds in between, as on a held stage. Decided between the first two neighbours that differ; false
// where none do. `evaluate` may be any function of a time to what compares.
template <typename Evaluate>
bool holds_between(std::span<const double> times01, const Evaluate& evaluate) {
  for (std::size_t i = 1; i < times01.size(); ++i) {
    const auto before = evaluate(times01[i - 1]), after = evaluate(times01[i]);
    if (before == after) continue;
    return std::ranges::all_of(kProbes, [&](double share) {
      const auto between = evaluate(times01[i - 1] + share * (times01[i] - times01[i - 1]));
      return between == before || between == after;
    });
  }
  return false;
}

// More jumps than this within the shutter are no jumps, but a curve.
inline constexpr std::size_t kMostJumps = 128;

// Where a held value of the shutter jumps, increasing, each found to a share of kBeforeJump01 and never too
// early: for hosts that do not say where what they evaluate has samples. `same(a, b)`: whether it is the same
// at two times. Jumps there and back within 1/64 of the shutter may hide. Empty for more than kMostJumps.
std::vector<double> jumps01(const std::function<bool(double, double)>& same);

}  // namespace msbvh::translate
