#include "delegate/translate/moving_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/lerp.h"
#include "core/motion/track.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/look/light_radiance.h"
#include "delegate/translate/time_samples.h"
#include "delegate/translate/value_track.h"

namespace msbvh::translate {
namespace {

// A step of more than this share of the largest power between two samples within kJumpTime01 is a jump.
constexpr double kJumpShare = 1e-3;

LightValues mixed(std::span<const LightValues> samples, const Mix& mix) {
  Vec3d radiance;
  std::array<double, kLightNumbers.size()> numbers{};
  for (const Share& share : mix) {
    const LightValues& v = samples[share.sample];
    radiance = radiance + Vec3d(v.radiance) * share.weight;
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += share.weight * v.*kLightNumbers[i].value;
  }
  LightValues result;
  result.radiance = Vec3f(radiance);
  for (std::size_t i = 0; i < numbers.size(); ++i) result.*kLightNumbers[i].value = float(numbers[i]);
  return result;
}

// In the world; for distant lights the solid angle. 1 where radiance alone says how bright the light is.
double size_of(LightKind kind, const LightValues& v, const Affine3d& map) {
  if (kind == LightKind::kSphere && v.radius > 0.0f) {
    return std::pow(std::abs(map.determinant()), 2.0 / 3.0) * v.radius * v.radius;
  }
  if (kind == LightKind::kRect) return length(cross(map.x, map.y)) * v.width * v.height;
  if (kind == LightKind::kDisk) return length(cross(map.x, map.y)) * v.radius * v.radius;
  if (kind == LightKind::kCylinder)
    return length(map.x) * std::sqrt(length(cross(map.y, map.z))) * v.length * v.radius;
  if (kind == LightKind::kDistant && v.angle_degrees > 0.0f) {
    const double sine = std::sin(v.angle_degrees * std::numbers::pi / 720.0);
    return 4.0 * std::numbers::pi * sine * sine;
  }
  return 1.0;
}

// A map that takes a fixed box around the unit light to this one.
Affine3d with_size(LightKind kind, const LightValues& v, const Affine3d& map) {
  const double radius = v.radius;
  if (kind == LightKind::kSphere) return {map.x * radius, map.y * radius, map.z * radius, map.t};
  if (kind == LightKind::kRect) return {map.x * double(v.width), map.y * double(v.height), map.z, map.t};
  if (kind == LightKind::kDisk) return {map.x * radius, map.y * radius, map.z, map.t};
  if (kind == LightKind::kCylinder) return {map.x * double(v.length), map.y * radius, map.z * radius, map.t};
  return map;
}

// The light at one time.
struct Instant {
  LightValues values;
  Affine3d map;
};

// Values and transform of the samples, and of tracks with any number of segments.
class LightMotion {
 public:
  LightMotion(const LightInput& input, const TransformTrack& transform)
      : kind_(input.light.kind),
        times01_(input.values_times01),
        values_(input.values),
        transform_(transform) {
    std::vector<double> all01 = times01_;
    all01.insert(all01.end(), transform.times01().begin(), transform.times01().end());
    knots01_ = knots(all01, 0);
    for (std::size_t i = 0; i < values_.size(); ++i) largest_power_ = std::max(largest_power_, power(i));
    keys_ = jumps() ? Keys::kAveraged : Keys::kSampled;
  }

  Keys keys() const { return keys_; }
  LightKind kind() const { return kind_; }
  // Increasing, as Deviation wants them.
  std::vector<double> tests01(std::uint32_t segments) const {
    std::vector<double> times01 = test_times(knots01_, segments);
    std::sort(times01.begin(), times01.end());
    return times01;
  }
  Instant at(double time01) const {
    return {mixed(values_, mix_at(times01_, time01)), transform_.at(time01)};
  }
  std::vector<Instant> track(std::uint32_t segments) const {
    const std::vector<Mix> mixes = key_mixes(times01_, segments, keys_);
    std::vector<Instant> result;
    for (std::uint32_t key = 0; key < key_count(segments); ++key) {
      result.push_back({mixed(values_, mixes[key]), transform_.at(key_time(key, segments))});
    }
    return result;
  }
  bool values_are_still() const {
    return std::all_of(values_.begin(), values_.end(), [&](const LightValues& v) { return v == values_[0]; });
  }
  // By colour, as shares of the largest power of all samples.
  Vec3d power_difference(const Instant& a, const Instant& b) const {
    const Vec3d difference = Vec3d(a.values.radiance) * size_of(kind_, a.values, a.map) -
                             Vec3d(b.values.radiance) * size_of(kind_, b.values, b.map);
    return largest_power_ > 0.0 ? difference * (1.0 / largest_power_) : Vec3d{};
  }

 private:
  double power(std::size_t sample) const {
    return length(Vec3d(values_[sample].radiance)) *
           size_of(kind_, values_[sample], transform_.at(times01_[sample]));
  }
  bool jumps() const {
    for (std::size_t i = 1; i < values_.size(); ++i) {
      if (times01_[i] - times01_[i - 1] > kJumpTime01) continue;
      if (std::abs(power(i) - power(i - 1)) > kJumpShare * largest_power_) return true;
    }
    return false;
  }

  LightKind kind_;
  std::vector<double> times01_;
  std::span<const LightValues> values_;
  const TransformTrack& transform_;
  std::vector<double> knots01_;
  double largest_power_ = 0.0;
  Keys keys_ = Keys::kSampled;
};

Instant interpolated(const std::vector<Instant>& keys, double time01) {
  const auto segments = std::uint32_t(keys.size() - 1);
  if (segments == 0) return keys[0];
  const TrackTime at = locate_key(time01, segments);
  const Instant &a = keys[at.key], &b = keys[at.key + 1];
  const Share shares[] = {{0, 1.0 - at.w}, {1, at.w}};
  const LightValues ends[] = {a.values, b.values};
  return {mixed(ends, {shares[0], shares[1]}), lerp(a.map, b.map, at.w)};
}

struct Errors {
  double pixels, power_share;
};

// Around the light of size 1.
Box3d unit_box(LightKind kind) {
  const double x = kind == LightKind::kRect || kind == LightKind::kCylinder ? 0.5 : 1.0;
  const double y = kind == LightKind::kRect ? 0.5 : 1.0;
  const double z = kind == LightKind::kRect || kind == LightKind::kDisk ? 0.0 : 1.0;
  return {{-x, -y, -z}, {x, y, z}};
}

double pixels_between(LightKind kind, const Instant& truth, const Instant& track,
                      const ScreenInstant& screen) {
  const BoxCorners corners = corners_of(unit_box(kind));
  const Affine3d a = with_size(kind, truth.values, truth.map), b = with_size(kind, track.values, track.map);
  double distance = largest_distance(corners, a, b);
  if (kind == LightKind::kDistant) {  // the rim of its disc moves by half the change of its angle
    distance += std::abs(double(truth.values.angle_degrees) - track.values.angle_degrees) *
                (std::numbers::pi / 360.0);
  }
  return distance == 0.0 ? 0.0 : screen.in_box(distance, bounds_of(corners, a));
}

Errors errors(const LightMotion& motion, const ScreenMeasure& measure, std::uint32_t segments) {
  const std::vector<Instant> keys = motion.track(segments);
  Deviation moved(Keys::kSampled);  // a jump of the values is no excuse for the transform
  Deviation resized(motion.keys()), power(motion.keys());
  for (const double time01 : motion.tests01(segments)) {
    const Instant truth = motion.at(time01), track = interpolated(keys, time01);
    const auto pixels = [&](const Instant& other) {
      return Vec3d{pixels_between(motion.kind(), truth, other, measure.at(time01)), 0.0, 0.0};
    };
    moved.add(time01, pixels({truth.values, track.map}));
    resized.add(time01, pixels({track.values, truth.map}));
    power.add(time01, motion.power_difference(truth, track));
  }
  return {moved.largest() + resized.largest(), power.largest()};
}

void report(const Errors& found, const LightMotion& motion, std::uint32_t segments,
            const FitSettings& settings, PrimLog& log) {
  report_fit({segments, found.pixels}, settings, "xformOpOrder", "the light's motion or size", log);
  if (found.power_share <= kPowerTolerance) return;
  const bool averaged = motion.keys() == Keys::kAveraged;
  log.warn("inputs:intensity",
           message("the light's power deviates by ", 100.0 * found.power_share, " % of its largest at ",
                   segments, " segments", averaged ? " (it jumps inside the shutter; its mean is kept)" : "",
                   "; expected at most ", 100.0 * kPowerTolerance, " %"));
}

std::uint32_t fewest(const LightMotion& motion, const ScreenMeasure& measure, const FitSettings& settings) {
  if (motion.keys() == Keys::kAveraged) return settings.max_segments;
  // Both errors in units of their tolerance.
  const auto error = [&](std::uint32_t segments, double) {
    const Errors found = errors(motion, measure, segments);
    return std::max(found.pixels / settings.tolerance, found.power_share / kPowerTolerance);
  };
  return fewest_segments({1.0, settings.max_segments}, error).segments;
}

}  // namespace

void fit_moving_light(const LightInput& input, const TransformTrack& transform, const ScreenMeasure& measure,
                      const FitSettings& settings, Light& light, PrimLog& log) {
  const LightMotion motion(input, transform);
  light.segments = fewest(motion, measure, settings);
  report(errors(motion, measure, light.segments), motion, light.segments, settings, log);
  const std::vector<Instant> keys = motion.track(light.segments);
  light.world_from_light.clear();
  for (const Instant& key : keys) light.world_from_light.push_back(Affine3f(key.map));
  if (light.segments == 0 || motion.values_are_still()) {
    static_cast<LightValues&>(light) = keys[0].values;
    return;
  }
  for (const Instant& key : keys) light.moving_values.push_back(key.values);
}

}  // namespace msbvh::translate
