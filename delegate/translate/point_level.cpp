// A point instancer's arrays as a level of instancing, by USD's own rules
// (UsdGeomPointInstancer::ComputeInstanceTransformsAtTimes): scale, then orientation, then the turn by
// angular velocity, then the position.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/base/lerp.h"
#include "core/geometry/triangle_mesh.h"
#include "delegate/translate/array_samples.h"
#include "delegate/translate/instance_chain.h"
#include "delegate/translate/rates.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {
namespace {

// Times a turn at which a spin is compared with its track.
constexpr double kTimesPerTurn = 16.0;
// So few turns in a shutter hide from no test.
constexpr double kFewTurns = 0.25;
// Beyond, tests no longer grow in number: at such a rate their places are as good as random.
constexpr double kMostTurns = kMostRepeats;

struct Quatd {
  double i, j, k, real;
};

Quatd in_double(const Quatf& q) { return {q.i, q.j, q.k, q.real}; }

// The linear part that a quaternion stands for. Like USD's, not normalised.
Affine3d rotation(const Quatd& q) {
  const double r = q.real, i = q.i, j = q.j, k = q.k;
  return {{1 - 2 * (j * j + k * k), 2 * (i * j + k * r), 2 * (k * i - j * r)},
          {2 * (i * j - k * r), 1 - 2 * (k * k + i * i), 2 * (j * k + i * r)},
          {2 * (k * i + j * r), 2 * (j * k - i * r), 1 - 2 * (i * i + j * j)},
          {}};
}

// Along the shorter arc; K. Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985. Linear
// where the arc is next to nothing, as in USD.
Quatd slerp(const Quatd& a, const Quatd& b, double w) {
  const double signed_cosine = a.i * b.i + a.j * b.j + a.k * b.k + a.real * b.real;
  const double cosine = std::abs(signed_cosine);
  double wa = 1.0 - w, wb = w;
  if (1.0 - cosine > 1e-5) {
    const double angle = std::acos(cosine), sine = std::sin(angle);
    wa = std::sin((1.0 - w) * angle) / sine;
    wb = std::sin(w * angle) / sine;
  }
  if (signed_cosine < 0.0) wa = -wa;
  return {wa * a.i + wb * b.i, wa * a.j + wb * b.j, wa * a.k + wb * b.k, wa * a.real + wb * b.real};
}

Quatd turn_about(const Vec3d& axis, double degrees) {
  const double half = degrees * (std::numbers::pi / 360.0);
  const Vec3d v = normalize(axis) * std::sin(half);
  return {v.x, v.y, v.z, std::cos(half)};
}

bool is_usable(const Vec3f& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) <= kMaxCoordinate && is_finite(v);
}
bool is_usable(const Quatf& q) {
  return std::isfinite(q.i) && std::isfinite(q.j) && std::isfinite(q.k) && std::isfinite(q.real);
}
std::string text(const Vec3f& v) { return message("(", v.x, ", ", v.y, ", ", v.z, ")"); }
std::string text(const Quatf& q) { return message("(", q.real, ", ", q.i, ", ", q.j, ", ", q.k, ")"); }

struct QuaternionInstant {
  std::span<const Quatf> first, second;
  double w = 0.0;

  Quatd operator[](std::size_t i) const {
    return w == 0.0 ? in_double(first[i]) : slerp(in_double(first[i]), in_double(second[i]), w);
  }
};

class PointLevel final : public ChainLevel {
 public:
  PointLevel(const InstanceLevel& level, PrimLog& log) : points_(*level.points), selected_(level.selected) {
    decide_positions(log);
    decide_orientations(log);
    interpolated_ = velocities_.empty() && angular_velocities_.empty();
    if (interpolated_) {
      positions_.emplace(sampled(points_.positions, "positions", log));
      if (size_of(points_.scales) > 0) scales_.emplace(sampled(points_.scales, "scales", log));
      keep_fitting_orientations(log);
    } else {
      const ArraySample& base = base_of(points_.positions);
      positions_.emplace(ArrayTrack(base, velocities_, accelerations_, points_.time_remap));
      if (size_of(points_.scales) > 0) scales_.emplace(ArrayTrack(only(base_of(points_.scales))));
      if (!orientations_.empty()) {
        orientations_ = {
            orientations_[base_sample(times_of(points_.orientations), points_.time_remap.frame01)]};
      }
    }
    warn_of_no_turn(log);
    for (std::size_t i = 0; i < selected_.size(); ++i) most_turns_ = std::max(most_turns_, turns(i));
    most_turns_ = std::min(most_turns_, kMostTurns);
  }

  std::size_t count() const override { return selected_.size(); }
  bool is_still() const override {
    return positions_->is_still() && (!scales_ || scales_->is_still()) && orientations_.size() < 2 &&
           angular_velocities_.empty();
  }
  std::vector<Breakpoint> breakpoints() const override {
    std::vector<Breakpoint> result = positions_->breakpoints();
    if (scales_) {
      const std::vector<Breakpoint> more = scales_->breakpoints();
      result.insert(result.end(), more.begin(), more.end());
    }
    if (orientations_.size() > 1) {
      for (const QuaternionSample& s : orientations_) result.push_back({s.time01, points_.orientations.held});
    }
    return normalized_breakpoints(std::move(result));
  }
  // Interpolated orientations turn by half a turn at most between their samples, which are breakpoints.
  std::vector<double> dense_times01() const override {
    const auto count = has_dense_times() ? std::size_t(std::ceil(kTimesPerTurn * most_turns_)) : 0;
    std::vector<double> result;
    // Not quite even, so that they have no period of their own.
    for (std::size_t i = 0; i < count; ++i) {
      const double place = double(i) + 0.25 + 0.5 * std::fmod(double(i) * std::numbers::phi, 1.0);
      result.push_back(place / double(count));
    }
    return result;
  }
  bool has_dense_times() const override { return most_turns_ > kFewTurns; }
  std::size_t dense_stride(std::size_t index) const override {
    const double own = std::max(turns(index), kFewTurns / kTimesPerTurn);
    return std::bit_floor(std::max<std::size_t>(1, std::size_t(most_turns_ / own)));
  }
  std::vector<double> periods01() const override {
    std::vector<double> result;
    for (std::size_t i = 0; i < selected_.size() && !angular_velocities_.empty(); ++i) {
      const double period01 = 1.0 / turns(i);
      if (!is_period(period01) || std::ranges::find(result, period01) != result.end()) continue;
      result.push_back(period01);
      if (result.size() > kMostPeriods) break;
    }
    return result;
  }
  std::unique_ptr<LevelInstant> at(double time01, double within) const override {
    auto instant = std::make_unique<Instant>(*this, positions_->at(time01, within));
    if (scales_) instant->scales = scales_->at(time01, within);
    if (!orientations_.empty()) instant->orientations = orientations_at(time01, within);
    if (!angular_velocities_.empty())
      instant->angular_dt = (time01 - angular_base01_) * points_.time_remap.seconds_per_shutter;
    return instant;
  }
  std::string rule() const override {
    if (is_still()) return "still";
    if (interpolated_)
      return points_.positions.held ? "arrays held from sample to sample"
                                    : "arrays interpolated between samples";
    std::string rule = "one base sample carried by";
    if (!velocities_.empty()) rule += accelerations_.empty() ? " velocities" : " velocities, accelerations";
    if (!angular_velocities_.empty())
      rule += velocities_.empty() ? " angularVelocities" : ", angularVelocities";
    return rule;
  }
  std::optional<Blame> blame(std::size_t index) const override {
    const auto i = std::size_t(selected_[index]);
    std::optional<Blame> result;
    const auto look = [&](const std::string& name, double time01, const auto& values) {
      if (result || values.empty() || is_usable(values[i])) return;
      result = {name, message("value ", i, " ", at_shutter_time(time01), " is ", text(values[i])),
                points_.path};
    };
    const auto look_through = [&](const char* name, const ArrayTrack& track) {
      for (std::size_t s = 0; s < track.times01().size(); ++s)
        look(name, track.times01()[s], track.values(s));
    };
    look_through("positions", *positions_);
    if (scales_) look_through("scales", *scales_);
    for (const QuaternionSample& s : orientations_) look(points_.orientations_name, s.time01, s.values);
    look("velocities", positions_->times01().front(), velocities_);
    look("accelerations", positions_->times01().front(), accelerations_);
    look("angularVelocities", angular_base01_, angular_velocities_);
    return result;
  }

 private:
  struct Instant final : LevelInstant {
    Instant(const PointLevel& level_, const ArrayInstant& positions_)
        : level(level_), positions(positions_) {}
    Affine3d map(std::size_t index) const override {
      const auto i = std::size_t(level.selected_[index]);
      Affine3d result;
      if (orientations) {
        result = rotation((*orientations)[i]);
        if (!level.angular_velocities_.empty()) {
          const Vec3d rate =
              Vec3d(level.angular_velocities_[i]) * double(level.points_.time_remap.velocity_scale);
          result = rotation(turn_about(rate, angular_dt * length(rate))) * result;
        }
      }
      if (scales) {
        const Vec3d s = (*scales)[i];
        result = {result.x * s.x, result.y * s.y, result.z * s.z, {}};
      }
      result.t = positions[i];
      return result;
    }
    const PointLevel& level;
    ArrayInstant positions;
    std::optional<ArrayInstant> scales;
    std::optional<QuaternionInstant> orientations;
    double angular_dt = 0.0;
  };

  // Of one thing over the shutter, by its angular velocity; 0 where that is no usable number.
  double turns(std::size_t index) const {
    if (angular_velocities_.empty()) return 0.0;
    const Vec3d rate = Vec3d(angular_velocities_[std::size_t(selected_[index])]);
    const double degrees = length(rate) * std::abs(double(points_.time_remap.velocity_scale) *
                                                   points_.time_remap.seconds_per_shutter);
    return std::isfinite(degrees) ? degrees / 360.0 : 0.0;
  }
  const ArraySample& base_of(const ArraySamples& samples) const {
    return samples.samples[base_sample(times_of(samples), points_.time_remap.frame01)];
  }
  std::size_t size_of(const ArraySamples& samples) const {
    return samples.empty() ? 0 : base_of(samples).values.size();
  }
  static ArraySamples only(const ArraySample& sample) { return {{sample}, false, true}; }

  void decide_positions(PrimLog& log) {
    const RateInput& rates = points_.rates;
    const RateCheck velocities{
        times_of(points_.positions), times_of(rates.velocities), "positions", "velocities",
        size_of(points_.positions),  size_of(rates.velocities)};
    if (!rate_applies(velocities, points_.time_remap.frame01, log)) return;
    velocities_ = base_of(rates.velocities).values;
    const RateCheck accelerations{velocities.rate,      times_of(rates.accelerations),
                                  "velocities",         "accelerations",
                                  velocities.rate_size, size_of(rates.accelerations)};
    if (rate_applies(accelerations, points_.time_remap.frame01, log))
      accelerations_ = base_of(rates.accelerations).values;
  }
  void decide_orientations(PrimLog& log) {
    const QuaternionSamples& q = points_.orientations;
    if (q.samples.empty()) return;
    const SampleTimes times = times_of(q);
    const std::size_t base = base_sample(times, points_.time_remap.frame01);
    if (q.samples[base].values.empty()) return;
    const RateCheck angular{times,
                            times_of(points_.angular_velocities),
                            points_.orientations_name,
                            "angularVelocities",
                            q.samples[base].values.size(),
                            size_of(points_.angular_velocities)};
    if (rate_applies(angular, points_.time_remap.frame01, log)) {
      angular_velocities_ = base_of(points_.angular_velocities).values;
      angular_base01_ = base_of(points_.angular_velocities).time01;
    }
    orientations_ = q.samples;
  }
  // Samples with other counts than the frame's do not count (USD takes the base sample there).
  ArrayTrack sampled(const ArraySamples& samples, const char* name, PrimLog& log) const {
    const std::size_t base = base_sample(times_of(samples), points_.time_remap.frame01);
    const ArraySamples fitting = samples_of_size(samples, base, points_.count);
    if (fitting.samples.size() < samples.samples.size()) warn_of_count(name, log);
    return ArrayTrack(fitting);
  }
  void keep_fitting_orientations(PrimLog& log) {
    if (orientations_.empty()) return;
    const std::size_t before = orientations_.size();
    const std::size_t base = base_sample(times_of(points_.orientations), points_.time_remap.frame01);
    const auto fits = [&](std::size_t i) { return orientations_[i].values.size() == points_.count; };
    std::size_t first = base, last = base;
    while (first > 0 && fits(first - 1)) --first;
    while (last + 1 < before && fits(last + 1)) ++last;
    orientations_ = {orientations_.begin() + std::ptrdiff_t(first),
                     orientations_.begin() + std::ptrdiff_t(last) + 1};
    if (orientations_.size() < before) warn_of_count(points_.orientations_name, log);
    const bool same = std::ranges::all_of(orientations_, [&](const QuaternionSample& s) {
      return std::equal(s.values.begin(), s.values.end(), orientations_.front().values.begin(),
                        [](const Quatf& a, const Quatf& b) {
                          return a.i == b.i && a.j == b.j && a.k == b.k && a.real == b.real;
                        });
    });
    if (same) orientations_.resize(1);
  }
  // USD makes the identity of them.
  void warn_of_no_turn(PrimLog& log) const {
    for (const QuaternionSample& s : orientations_) {
      const auto zero = std::ranges::find_if(selected_, [&](int i) {
        const Quatf& q = s.values[std::size_t(i)];
        return q.i == 0.0f && q.j == 0.0f && q.k == 0.0f && q.real == 0.0f;
      });
      if (zero == selected_.end()) continue;
      log.warn(points_.orientations_name, message("value ", *zero, " ", at_shutter_time(s.time01),
                                                  " is (0, 0, 0, 0); expected a quaternion of length 1; "
                                                  "taken as no rotation, as USD has it"));
      return;
    }
  }
  void warn_of_count(const std::string& name, PrimLog& log) const {
    log.warn(name, message("the number of values changes beside the frame's ", points_.count,
                           " and no velocities apply; the nearest sample with as many is held"));
  }
  QuaternionInstant orientations_at(double time01, double within) const {
    std::vector<double> times01;
    for (const QuaternionSample& s : orientations_) times01.push_back(s.time01);
    const bool held = points_.orientations.held;
    const Bracket at = bracket(times01, held ? within : time01, held);
    return {orientations_[at.first].values, orientations_[at.second].values, at.w};
  }

  const PointInstancerInput& points_;
  std::span<const int> selected_;
  std::optional<ArrayTrack> positions_, scales_;
  std::vector<QuaternionSample> orientations_;
  std::span<const Vec3f> velocities_, accelerations_, angular_velocities_;
  double angular_base01_ = 0.0;
  double most_turns_ = 0.0;
  bool interpolated_ = true;
};

template <typename Samples>
bool check_base(const Samples& samples, const std::string& name, bool optional,
                const PointInstancerInput& points, PrimLog& log) {
  if (samples.samples.empty() && optional) return true;
  const SampleTimes times = times_of(samples);
  if (!check_times(times.times01, name, log)) return false;
  const std::size_t found = samples.samples[base_sample(times, points.time_remap.frame01)].values.size();
  if (found == points.count || (found == 0 && optional)) return true;
  return log.reject(name, message("found ", found, " values, expected ", points.count, ", one an instance"));
}

bool check(const InstanceLevel& level, PrimLog& log) {
  const PointInstancerInput& points = *level.points;
  if (!check_base(points.positions, "positions", false, points, log) ||
      !check_base(points.scales, "scales", true, points, log) ||
      !check_base(points.orientations, points.orientations_name, true, points, log)) {
    return false;
  }
  const auto bad =
      std::ranges::find_if(level.selected, [&](int i) { return i < 0 || std::size_t(i) >= points.count; });
  if (bad == level.selected.end()) return true;
  return log.reject("instances", message("found the index ", *bad, "; expected less than ", points.count));
}

}  // namespace

std::unique_ptr<ChainLevel> make_point_level(const InstanceLevel& level, PrimLog& log) {
  if (!check(level, log)) return nullptr;
  return std::make_unique<PointLevel>(level, log);
}

}  // namespace msbvh::translate
