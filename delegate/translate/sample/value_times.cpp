#include "delegate/translate/sample/value_times.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "delegate/translate/sample/even_times.h"

namespace msbvh::translate {
namespace {

using Times = std::map<double, ValueTime>;

// What is there already stays.
void add(Times& times, double time01, double read_at01, std::optional<std::size_t> authored = std::nullopt) {
  times.try_emplace(time01, ValueTime{time01, read_at01, authored});
}

bool is_seen(double time01) { return time01 <= 1.0 - kBeforeJump01; }

void add_instant_before(Times& times, double time01) {
  if (time01 > kBeforeJump01) add(times, time01 - kBeforeJump01, time01 - kBeforeJump01);
}

// To the nearest of them.
double distance(const Times& times, double time01) {
  const Times::const_iterator after = times.lower_bound(time01);
  double nearest = INFINITY;
  if (after != times.end()) nearest = after->first - time01;
  if (after != times.begin()) nearest = std::min(nearest, time01 - std::prev(after)->first);
  return nearest;
}

}  // namespace

std::vector<ValueTime> value_times(std::span<const double> authored01, std::span<const double> switched01) {
  Times known;
  for (std::size_t i = 0; i < authored01.size(); ++i) {
    if (is_seen(authored01[i])) add(known, authored01[i], authored01[i], i);
  }
  for (const double time01 : switched01) {
    if (is_seen(time01)) add(known, time01, time01);
  }
  add(known, 1.0, 1.0 - kBeforeJump01);
  for (const std::span<const double> all01 : {authored01, switched01}) {
    for (const double time01 : all01) {
      if (is_seen(time01)) add_instant_before(known, time01);
    }
  }
  Times all = known;
  constexpr std::size_t kIntervals = std::size_t(1) << kFinestLevel;
  for (std::size_t i = 0; i <= kIntervals; ++i) {
    const double even = double(i) / double(kIntervals);
    if (distance(known, even) > kSameEvenTime01) add(all, even, even);
  }
  std::vector<ValueTime> times;
  for (const auto& [time01, time] : all) times.push_back(time);
  return times;
}

}  // namespace msbvh::translate
