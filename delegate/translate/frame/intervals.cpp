#include "delegate/translate/frame/intervals.h"

#include <algorithm>

namespace msbvh::translate {
namespace {

constexpr double kBehindClosing01 = 2.0;

}  // namespace

std::vector<VisibleInterval> intervals_between(std::span<const double> begins01) {
  std::vector<VisibleInterval> intervals;
  for (std::size_t i = 0; i < begins01.size(); ++i) {
    intervals.push_back({begins01[i], i + 1 < begins01.size() ? begins01[i + 1] : kBehindClosing01});
  }
  return intervals;
}

Visibility visible_intervals(std::span<const double> begins01, std::span<const bool> shown) {
  if (std::ranges::all_of(shown, [](bool each) { return each; })) return std::nullopt;
  const std::vector<VisibleInterval> every = intervals_between(begins01);
  std::vector<VisibleInterval> visible;
  for (std::size_t i = 0; i < every.size(); ++i) {
    if (!shown[i]) continue;
    if (!visible.empty() && visible.back().end01 == every[i].begin01) {
      visible.back().end01 = every[i].end01;
    } else {
      visible.push_back(every[i]);
    }
  }
  return visible;
}

Visibility common_intervals(const Visibility& a, const Visibility& b) {
  if (!a || !b) return a ? a : b;
  std::vector<VisibleInterval> common;
  for (const VisibleInterval& x : *a) {
    for (const VisibleInterval& y : *b) {
      const VisibleInterval both{std::max(x.begin01, y.begin01), std::min(x.end01, y.end01)};
      if (both.begin01 < both.end01) common.push_back(both);
    }
  }
  return common;
}

}  // namespace msbvh::translate
