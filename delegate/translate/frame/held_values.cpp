#include "delegate/translate/frame/held_values.h"

#include <algorithm>

#include "delegate/translate/sample/even_times.h"

namespace msbvh::translate {
namespace {

constexpr int kFirstIntervals = 64;
constexpr double kJumpFound01 = kBeforeJump01 / 16.0;

// Halves an interval whose ends differ until each jump in it is found.
void find_jumps(double begin01, double end01, const std::function<bool(double, double)>& same,
                std::vector<double>& found) {
  if (found.size() > kMostJumps || same(begin01, end01)) return;
  if (end01 - begin01 <= kJumpFound01) {
    found.push_back(end01);
    return;
  }
  const double middle01 = 0.5 * (begin01 + end01);
  find_jumps(begin01, middle01, same, found);
  find_jumps(middle01, end01, same, found);
}

}  // namespace

std::vector<HeldStretch> held_stretches(std::span<const double> begins01,
                                        std::span<const std::size_t> kinds) {
  std::vector<HeldStretch> found;
  const std::vector<VisibleInterval> every = intervals_between(begins01);
  for (std::size_t i = 0; i < every.size(); ++i) {
    const auto known =
        std::ranges::find_if(found, [&](const HeldStretch& each) { return kinds[each.first] == kinds[i]; });
    if (known != found.end()) {
      known->shown->push_back(every[i]);
      continue;
    }
    if (found.size() == kMostStretches) return {};
    found.push_back({i, std::vector{every[i]}});
  }
  if (found.size() == 1) found.front().shown.reset();
  return found;
}

std::vector<double> knots_within(std::span<const double> authored01, std::span<const VisibleInterval> shown) {
  std::vector<double> knots;
  for (const VisibleInterval& part : shown) {
    const double last01 = std::min(part.end01, 1.0) - kBeforeJump01;
    knots.push_back(part.begin01);
    for (const double time01 : authored01) {
      if (part.begin01 < time01 && time01 < last01) knots.push_back(time01);
    }
    if (last01 > part.begin01) knots.push_back(last01);
  }
  return knots;
}

std::vector<double> jumps01(const std::function<bool(double, double)>& same) {
  std::vector<double> found;
  for (int i = 0; i < kFirstIntervals; ++i)
    find_jumps(double(i) / kFirstIntervals, double(i + 1) / kFirstIntervals, same, found);
  if (found.size() > kMostJumps) found.clear();
  return found;
}

}  // namespace msbvh::translate
