#include "delegate/translate/sample/turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "delegate/translate/time_layout.h"

namespace msbvh::translate {
namespace {

// Rates that differ by less, relative to the rate, are one: what sums of time codes round.
constexpr double kSameRate = 1e-9;
constexpr double kDegreesATurn = 360.0;

std::vector<double> merged(std::span<const double> a, std::span<const double> b) {
  std::vector<double> both(a.size() + b.size());
  std::ranges::merge(a, b, both.begin());
  both.erase(std::unique(both.begin(), both.end()), both.end());
  return both;
}

void add_period(std::vector<double>& periods01, double period01) {
  if (is_period(period01)) periods01.push_back(period01);
}

void sort_once(std::vector<double>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// The stretch between ends that begins at or before a time.
std::size_t stretch_at(std::span<const double> ends01, double time01) {
  const std::size_t after = std::size_t(std::ranges::upper_bound(ends01, time01) - ends01.begin());
  return std::clamp<std::size_t>(after, 1, ends01.size() - 1) - 1;
}

// Whether all steps of an axis have the same rate.
bool is_uniform(std::span<const double> times01, std::span<const double> degrees, std::size_t axes,
                std::size_t axis, double turned) {
  double least = INFINITY, most = -INFINITY;
  for (std::size_t t = 1; t < times01.size(); ++t) {
    const double step = (degrees[t * axes + axis] - degrees[(t - 1) * axes + axis]) / kDegreesATurn;
    const double rate = step / (times01[t] - times01[t - 1]);
    least = std::min(least, rate);
    most = std::max(most, rate);
  }
  return most - least <= kSameRate * turned;
}

Quatd unit(const Quatd& q) {
  const double size = std::sqrt(q.real * q.real + q.i * q.i + q.j * q.j + q.k * q.k);
  return size > 0.0 ? Quatd{q.i / size, q.j / size, q.k / size, q.real / size} : q;
}

// In turns, from one rotation to another.
double arc(const Quatd& a, const Quatd& b) {
  const double cosine = std::abs(a.real * b.real + a.i * b.i + a.j * b.j + a.k * b.k);
  return std::acos(std::min(cosine, 1.0)) / std::numbers::pi;
}

// Joints, each behind what it hangs on.
std::vector<std::size_t> parents_first(std::span<const int> parents) {
  std::vector<std::size_t> depths, order(parents.size());
  for (int parent : parents) {
    std::size_t depth = 0;
    for (; parent >= 0; parent = parents[std::size_t(parent)]) {
      if (std::size_t(parent) >= parents.size() || ++depth >= parents.size()) {
        throw Error("parents: found " + std::to_string(parent) + "; expected one of " +
                    std::to_string(parents.size()) + " joints, and none above itself");
      }
    }
    depths.push_back(depth);
  }
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, {}, [&](std::size_t joint) { return depths[joint]; });
  return order;
}

}  // namespace

Turns::Turns(std::vector<double> times01, std::vector<double> total, std::vector<double> periods01)
    : times01_(std::move(times01)), total_(std::move(total)), periods01_(std::move(periods01)) {
  if (times01_.size() < 2 || times01_.size() != total_.size()) {
    throw Error("turns: found " + std::to_string(times01_.size()) + " times and " +
                std::to_string(total_.size()) + " totals; expected two or more of each, and as many");
  }
  sort_once(periods01_);
}

Turns Turns::operator+(const Turns& other) const {
  if (none() || other.none()) return none() ? other : *this;
  std::vector<double> times01 = merged(times01_, other.times01_);
  std::vector<double> total;
  for (const double time01 : times01) total.push_back(at(time01) + other.at(time01));
  return Turns(std::move(times01), std::move(total), merged(periods01_, other.periods01_));
}

double Turns::at(double time01) const {
  if (time01 <= times01_.front()) return total_.front();
  if (time01 >= times01_.back()) return total_.back();
  const std::size_t i = stretch_at(times01_, time01);
  const double slope = (total_[i + 1] - total_[i]) / (times01_[i + 1] - times01_[i]);
  return total_[i] + slope * (time01 - times01_[i]);
}

std::vector<double> Turns::within(std::span<const double> ends01) const {
  std::vector<double> turns(ends01.size() - 1, 0.0);
  if (times01_.size() == 2) {
    for (std::size_t i = 0; i < turns.size(); ++i) turns[i] = total_.back() * (ends01[i + 1] - ends01[i]);
    return turns;
  }
  const std::vector<double> times01 = merged(times01_, ends01);
  for (std::size_t i = 0; i + 1 < times01.size(); ++i) {
    const double length = times01[i + 1] - times01[i];
    if (length <= kSameTime) continue;  // Times that differ by rounding alone: there is no rate.
    double& most = turns[stretch_at(ends01, times01[i])];
    most = std::max(most, (at(times01[i + 1]) - at(times01[i])) / length);
  }
  for (std::size_t i = 0; i < turns.size(); ++i) turns[i] *= ends01[i + 1] - ends01[i];
  return turns;
}

double Turns::rate() const {
  constexpr double kShutter[] = {0.0, 1.0};
  return within(kShutter).front();
}

Turns uniform_turns(double turns) {
  if (!(std::isfinite(turns) && turns > 0.0)) return {};
  const double period01 = 1.0 / turns;
  return Turns({0.0, 1.0}, {0.0, turns}, usable_periods01({&period01, 1}));
}

Turns angle_turns(std::vector<double> times01, std::span<const double> degrees, std::size_t axes,
                  std::span<const double> loop_periods01) {
  std::vector<double> total{0.0}, periods01(loop_periods01.begin(), loop_periods01.end());
  for (std::size_t t = 1; t < times01.size(); ++t) {
    double turned = 0.0;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      turned += std::abs((degrees[t * axes + axis] - degrees[(t - 1) * axes + axis]) / kDegreesATurn);
    }
    total.push_back(total.back() + turned);
  }
  if (!(total.back() > 0.0) || !std::isfinite(total.back())) return {};
  const std::size_t last = (times01.size() - 1) * axes;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const double turned = std::abs(degrees[last + axis] - degrees[axis]) / kDegreesATurn;
    if (is_uniform(times01, degrees, axes, axis, turned)) add_period(periods01, 1.0 / turned);
  }
  return Turns(std::move(times01), std::move(total), usable_periods01(periods01));
}

Turns orientation_turns(std::vector<double> times01, std::span<const Quatd> orientations) {
  const auto cosine = [](const Quatd& a, const Quatd& b) {
    return a.i * b.i + a.j * b.j + a.k * b.k + a.real * b.real;
  };
  std::vector<double> total{0.0};
  for (std::size_t t = 1; t < times01.size(); ++t) {
    const Quatd &a = orientations[t - 1], &b = orientations[t];
    const double lengths = std::sqrt(cosine(a, a)) * std::sqrt(cosine(b, b));
    const double c = std::abs(cosine(a, b)) / (lengths > 0.0 ? lengths : 1.0);
    total.push_back(total.back() + std::acos(std::clamp(c, 0.0, 1.0)) / std::numbers::pi);
  }
  if (!(total.back() > 0.0)) return {};
  return Turns(std::move(times01), std::move(total));
}

Turns joint_turns(std::vector<double> times01, std::span<const Quatd> rotations,
                  std::span<const int> parents) {
  const std::size_t joints = parents.size();
  const std::vector<std::size_t> order = parents_first(parents);
  std::vector<double> total{0.0}, turned(joints);
  for (std::size_t t = 1; t < times01.size(); ++t) {
    double most = 0.0;
    for (const std::size_t joint : order) {
      turned[joint] = arc(unit(rotations[(t - 1) * joints + joint]), unit(rotations[t * joints + joint]));
      if (!std::isfinite(turned[joint])) return {};
      if (parents[joint] >= 0) turned[joint] += turned[std::size_t(parents[joint])];
      most = std::max(most, turned[joint]);
    }
    total.push_back(total.back() + most);
  }
  if (!(total.back() > 0.0)) return {};
  return Turns(std::move(times01), std::move(total));
}

std::vector<double> usable_periods01(std::span<const double> periods01) {
  std::vector<double> usable;
  for (const double period01 : periods01) add_period(usable, period01);
  sort_once(usable);
  return usable;
}

}  // namespace msbvh::translate
