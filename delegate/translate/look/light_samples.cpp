#include "delegate/translate/look/light_samples.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "delegate/translate/sample/even_times.h"

namespace msbvh::translate {
namespace {

constexpr double kUneven = 1e-5;  // share by which squared lengths may differ

void check_counts(const LightSamples& samples, const char* name) {
  const std::size_t times = samples.times01.size();
  if (times > 0 && samples.emission.size() == times && samples.numbers.size() == times &&
      samples.normalize.size() == times)
    return;
  throw Error(std::string(name) + ": found " + std::to_string(times) + " times, " +
              std::to_string(samples.emission.size()) + " emissions, " +
              std::to_string(samples.numbers.size()) + " sets of numbers and " +
              std::to_string(samples.normalize.size()) +
              " flags; expected one of each a time, and a time at least");
}

bool is_finite(const LightNumbers& numbers) {
  return std::ranges::all_of(kLightNumbers,
                             [&](const LightNumber& each) { return std::isfinite(numbers.*each.number); });
}

// At its first time.
bool starts_finite(const LightSamples& samples) {
  return is_finite(samples.emission.front()) && is_finite(samples.numbers.front());
}

void keep_first(LightSamples& samples) {
  samples.times01.resize(1);
  samples.emission.resize(1);
  samples.numbers.resize(1);
  samples.normalize.resize(1);
}

void keep_above_zero(std::vector<LightNumbers>& sizes, double LightNumbers::*size) {
  double largest = 0.0;
  for (const LightNumbers& each : sizes) largest = std::max(largest, each.*size);
  if (largest == 0.0) return;  // of no size throughout
  for (LightNumbers& each : sizes) {
    if (each.*size == 0.0) each.*size = kSmallestShare * largest;
  }
}

template <typename Values>
bool all_alike(const Values& values) {
  return std::ranges::all_of(values, [&](const auto& value) { return value == values.front(); });
}

bool all_alike(const LightSamples& samples) {
  return all_alike(samples.emission) && all_alike(samples.numbers) && all_alike(samples.normalize);
}

// Of one thing, at each of the times.
std::vector<Matrix4d> matrices_at(const MotionSource& motion, std::uint32_t which,
                                  std::span<const double> times01) {
  const double any = 0.0;
  std::vector<Matrix4d> matrices(motion.still() ? 1 : times01.size());
  motion.evaluate(motion.still() ? std::span(&any, 1) : times01, std::span(&which, 1), matrices);
  matrices.resize(times01.size(), matrices.front());
  return matrices;
}

// The same at more times, for what depends on the transform.
LightSamples repeated(const LightSamples& still, std::span<const double> times01) {
  const std::size_t times = times01.size();
  return {{times01.begin(), times01.end()},
          std::vector<Vec3d>(times, still.emission.front()),
          std::vector<LightNumbers>(times, still.numbers.front()),
          std::vector<bool>(times, still.normalize.front())};
}

Vec3d radiance_at(LightKind kind, const LightSamples& samples, std::size_t time, const Matrix4d& place) {
  return light_radiance(kind, samples.emission[time], samples.numbers[time], samples.normalize[time], place);
}

TransformSamples transform_of(std::span<const double> times01, std::span<const Matrix4d> places) {
  const std::size_t last = all_alike(places) ? 1 : times01.size();
  return {{times01.begin(), times01.begin() + std::ptrdiff_t(last)},
          {places.begin(), places.begin() + std::ptrdiff_t(last)}};
}

// Where they change.
void add_values(LightKind kind, const LightSamples& samples, std::span<const Matrix4d> places,
                LightInput& input) {
  std::vector<Vec3d> radiances;
  for (std::size_t t = 0; t < places.size(); ++t)
    radiances.push_back(radiance_at(kind, samples, t, places[t]));
  if (all_alike(radiances) && all_alike(samples.numbers)) return;
  input.values_times01 = samples.times01;
  for (std::size_t t = 0; t < places.size(); ++t)
    input.values.push_back(light_values(radiances[t], samples.numbers[t]));
}

}  // namespace

bool LightSwitches::on(std::size_t time, double time01) const {
  const auto is_inside = [time01](const VisibleInterval& part) {
    return part.begin01 <= time01 && time01 < part.end01;
  };
  return visible[time] && (!shown || std::ranges::any_of(*shown, is_inside));
}

std::vector<double> switch_times01(std::span<const VisibleInterval> shown) {
  std::vector<double> times01;
  for (const VisibleInterval& part : shown) {
    for (const double time01 : {part.begin01, part.end01}) {
      if (time01 > 0.0 && time01 < 1.0) times01.push_back(time01);
    }
  }
  return times01;
}

SampledLight::SampledLight(LightSamples at_frame) : at_frame_(std::move(at_frame)), over_shutter_(at_frame_) {
  check_counts(at_frame_, "at_frame");
  if (!at_frame_.still()) throw Error("at_frame: found more than one time");
}

SampledLight::SampledLight(LightSamples at_frame, LightSamples over_shutter, const LightSwitches& switches)
    : SampledLight(std::move(at_frame)) {
  check_counts(over_shutter, "over_shutter");
  const std::size_t times = over_shutter.times01.size();
  if (switches.visible.size() != times) {
    throw Error("visible: found " + std::to_string(switches.visible.size()) + " flags; expected " +
                std::to_string(times) + ", one a time");
  }
  over_shutter_ = std::move(over_shutter);
  for (std::size_t t = 0; t < times; ++t) {
    if (!switches.on(t, over_shutter_.times01[t])) over_shutter_.emission[t] = {};
  }
  for (std::size_t i = 0; i < kLightSizes; ++i)
    keep_above_zero(over_shutter_.numbers, kLightNumbers[i].number);
  if (!starts_finite(
          at_frame_)) {  // The frame lies outside of the shutter, or the samples show the fault too.
    at_frame_ = over_shutter_;
    keep_first(at_frame_);
  }
  if (all_alike(over_shutter_)) keep_first(over_shutter_);
}

std::vector<double> light_times01(const MotionSource& motion, bool held) {
  if (motion.still()) return {0.0};
  double fastest = 0.0;
  for (std::uint32_t i = 0; i < motion.count(); ++i) fastest = std::max(fastest, motion.turns(i).rate());
  return dense_times01(Density::kLight, fastest, motion.breakpoints01(), held);
}

LightInput placed_light(LightKind kind, const SampledLight& light, const MotionSource& motion,
                        std::uint32_t which, std::span<const double> times01, double frame01) {
  const std::vector<Matrix4d> places = matrices_at(motion, which, times01);
  const Matrix4d at_frame = matrices_at(motion, which, std::span(&frame01, 1)).front();
  const LightSamples& over = light.over_shutter();
  const LightSamples& values = over.still() ? over : light.at_frame();
  LightInput input;
  LightValues& own = input.light;
  own = light_values(radiance_at(kind, values, 0, at_frame), values.numbers.front());
  input.light.kind = kind;
  input.world_from_light = transform_of(times01, places);
  if (!over.still()) {
    const bool is_placed = std::ranges::find(over.normalize, true) != over.normalize.end();
    const std::vector<Matrix4d> same(over.times01.size(), at_frame);
    add_values(kind, over, is_placed ? matrices_at(motion, which, over.times01) : same, input);
  } else if (over.normalize.front() && !motion.still()) {
    add_values(kind, repeated(over, times01), places, input);
  }
  return input;
}

bool is_similarity(const Matrix4d& m) {
  const Vec3d rows[3] = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}};
  const double trace = dot(rows[0], rows[0]) + dot(rows[1], rows[1]) + dot(rows[2], rows[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double expected = i == j ? trace / 3.0 : 0.0;
      if (std::abs(dot(rows[i], rows[j]) - expected) > kUneven * trace) return false;
    }
  }
  return true;
}

}  // namespace msbvh::translate
