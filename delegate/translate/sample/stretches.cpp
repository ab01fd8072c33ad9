#include "delegate/translate/sample/stretches.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "delegate/translate/time_layout.h"

namespace msbvh::translate {
namespace {

constexpr double kProbe = 0.381966;  // of a stretch: off the even places

// Neighbouring samples and their weights.
struct Weights {
  std::size_t first, count;
  std::array<double, 4> weight;
};

// At `place` samples behind the first one of a stretch of `parts`; a line or a cubic.
Weights weights_at(double place, std::size_t parts, std::size_t degree) {
  const double back = degree == 3 ? 1.0 : 0.0, last = double(parts - degree);
  const double begin = std::clamp(std::floor(place) - back, 0.0, last);
  Weights weights{std::size_t(begin), degree + 1, {}};
  for (std::size_t i = 0; i <= degree; ++i) {
    weights.weight[i] = 1.0;
    for (std::size_t j = 0; j <= degree; ++j) {
      if (j != i) weights.weight[i] *= (place - begin - double(j)) / (double(i) - double(j));
    }
  }
  return weights;
}

Vec3d mixed(const CornerSamples& samples, const Weights& weights, std::size_t first, std::size_t thing,
            std::size_t corner) {
  Vec3d sum{0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < weights.count; ++k) {
    sum = sum + samples.at(first + weights.first + k, thing, corner) * weights.weight[k];
  }
  return sum;
}

}  // namespace

void raise_to(double& most, double value) {
  if (!(value <= most) && !std::isnan(most)) most = value;
}

Stretches::Stretches(std::span<const double> breakpoints01) {
  std::vector<double> sorted(breakpoints01.begin(), breakpoints01.end());
  std::ranges::sort(sorted);
  ends01_.push_back(0.0);
  for (const double time01 : sorted) {
    if (ends01_.back() + kSameTime < time01 && time01 < 1.0 - kSameTime) ends01_.push_back(time01);
  }
  ends01_.push_back(1.0);
}

bool Stretches::is_long(std::size_t stretch) const {
  return ends01_[stretch + 1] - ends01_[stretch] > kTimeResolution;
}

std::size_t Stretches::parts(std::size_t stretch, int split) const {
  return is_long(stretch) ? std::size_t(1) << split : 1;
}

std::vector<double> Stretches::times01(int split) const {
  std::vector<double> times01;
  for (std::size_t s = 0; s < count(); ++s) {
    const std::size_t n = parts(s, split);
    const double begin = ends01_[s], length = ends01_[s + 1] - begin;
    for (std::size_t i = 0; i < n; ++i) times01.push_back(begin + length * double(i) / double(n));
  }
  times01.push_back(ends01_.back());
  return times01;
}

std::vector<bool> Stretches::kept(int split) const {
  std::vector<bool> kept;
  for (std::size_t s = 0; s < count(); ++s) {
    for (std::size_t i = 0; i < parts(s, split); ++i) {
      kept.push_back(true);
      if (is_long(s)) kept.push_back(false);
    }
  }
  kept.push_back(true);
  return kept;
}

std::vector<double> Stretches::probes01() const {
  std::vector<double> probes01;
  for (std::size_t s = 0; s < count(); ++s) {
    probes01.push_back(ends01_[s] + kProbe * (ends01_[s + 1] - ends01_[s]));
  }
  return probes01;
}

std::vector<double> Stretches::strays(int split, const CornerSamples& samples,
                                      std::span<const double> probes01, const CornerSamples& probed) const {
  std::vector<double> strays(samples.things, 0.0);
  const std::size_t degree = split >= kCubicSplit ? 3 : 1;
  std::size_t stretch = 0, first = 0;
  for (std::size_t p = 0; p < probes01.size(); ++p) {
    while (stretch + 1 < count() && ends01_[stretch + 1] <= probes01[p]) first += parts(stretch++, split);
    if (!is_long(stretch)) continue;
    const double begin = ends01_[stretch], length = ends01_[stretch + 1] - begin;
    const std::size_t n = parts(stretch, split);
    const Weights weights = weights_at((probes01[p] - begin) / length * double(n), n, degree);
    for (std::size_t thing = 0; thing < samples.things; ++thing) {
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const Vec3d between = mixed(samples, weights, first, thing, corner);
        raise_to(strays[thing], msbvh::length(probed.at(p, thing, corner) - between));
      }
    }
  }
  return strays;
}

}  // namespace msbvh::translate
