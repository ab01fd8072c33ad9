#include "delegate/translate/sample/even_times.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/motion/track.h"

namespace msbvh::translate {
namespace {

static_assert(1u << kFinestLevel == kMaxSegments);

struct Course {
  int level;        // 2^level intervals at least
  double per_turn;  // times
};

Course course_of(Density density) {
  switch (density) {
    case Density::kCamera:
      return {10, 64.0};
    case Density::kLight:
      return {kFinestLevel, 64.0};
    case Density::kGlance:
      break;
  }
  return {1, 4.0};
}

void sort_once(std::vector<double>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

int even_level(double intervals) {
  const double level = std::ceil(std::log2(std::max(intervals, 1.0)));
  return int(std::min(level, double(kMostEvenLevel)));
}

std::vector<double> even_times01(int level, std::span<const double> breakpoints01, bool held) {
  std::vector<double> times01;
  for (const double time01 : breakpoints01) {
    if (!(time01 > kSameEvenTime01 && time01 < 1.0 - kSameEvenTime01)) continue;
    times01.push_back(time01);
    if (held && time01 > kBeforeJump01) times01.push_back(time01 - kBeforeJump01);
  }
  sort_once(times01);
  const std::size_t intervals = std::size_t(1) << level, own = times01.size();
  for (std::size_t i = 0; i <= intervals; ++i) {
    const double even = double(i) / double(intervals);
    const auto end = times01.begin() + std::ptrdiff_t(own);
    const auto near = std::lower_bound(times01.begin(), end, even - kSameEvenTime01);
    if (near == end || *near > even + kSameEvenTime01) times01.push_back(even);
  }
  sort_once(times01);
  return times01;
}

std::vector<double> dense_times01(Density density, double turns, std::span<const double> breakpoints01,
                                  bool held) {
  const Course course = course_of(density);
  return even_times01(std::max(course.level, even_level(course.per_turn * turns)), breakpoints01, held);
}

}  // namespace msbvh::translate
