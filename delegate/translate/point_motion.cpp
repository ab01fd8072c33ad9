#include "delegate/translate/point_motion.h"

#include <algorithm>

#include "delegate/translate/rates.h"

namespace msbvh::translate {
namespace {

constexpr const char* kPoints = "points";

const ArraySample& base_of(const ArraySamples& samples, double frame01) {
  return samples.samples[base_sample(times_of(samples), frame01)];
}
std::size_t base_size(const ArraySamples& samples, double frame01) {
  return samples.empty() ? 0 : base_of(samples, frame01).values.size();
}

// The rates that apply at the frame, each empty where it does not.
struct Carriers {
  std::span<const Vec3f> velocities, accelerations;
};

Carriers carriers_of(const MeshInput& input, PrimLog& log) {
  const double frame01 = input.time_remap.frame01;
  const RateInput& rates = input.rates;
  const RateCheck velocities{
      times_of(input.points), times_of(rates.velocities),       kPoints,
      "velocities",           base_size(input.points, frame01), base_size(rates.velocities, frame01)};
  if (!rate_applies(velocities, frame01, log)) return {};
  Carriers result{base_of(rates.velocities, frame01).values, {}};
  const RateCheck accelerations{velocities.rate,      times_of(rates.accelerations),
                                "velocities",         "accelerations",
                                velocities.rate_size, base_size(rates.accelerations, frame01)};
  if (rate_applies(accelerations, frame01, log)) {
    result.accelerations = base_of(rates.accelerations, frame01).values;
  }
  return result;
}

std::optional<PointMotion> carried(const MeshInput& input, const Carriers& by, PrimLog& log) {
  const ArraySample& base = base_of(input.points, input.time_remap.frame01);
  const bool usable = check_finite(base, kPoints, log) &&
                      check_finite({base.time01, by.velocities}, "velocities", log) &&
                      check_finite({base.time01, by.accelerations}, "accelerations", log);
  if (!usable) return std::nullopt;
  const bool straight = by.accelerations.empty();
  return PointMotion{
      ArrayTrack(base, by.velocities, by.accelerations, input.time_remap),
      straight ? "velocities" : "accelerations",
      message("velocities", straight ? "" : " and accelerations",
              " win: one base sample carried through the shutter", straight ? "" : ", quadratic"),
      true};
}

// USD holds what it has at the frame where it cannot interpolate.
std::optional<PointMotion> held_at_frame(const MeshInput& input, const ArraySamples& fitting, PrimLog& log) {
  log.warn(kPoints, "the topology changes within the shutter and no velocities apply; held the frame's pose");
  const std::vector<double> times01 = times_of(fitting).times01;
  const Bracket at = bracket(times01, input.time_remap.frame01, fitting.held);
  for (const std::size_t sample : {at.first, at.second}) {
    if (!check_finite(fitting.samples[sample], kPoints, log)) return std::nullopt;
  }
  auto pose = std::make_shared<std::vector<Vec3f>>();
  const ArrayInstant instant{fitting.samples[at.first].values, fitting.samples[at.second].values, {}, at.w};
  for (std::size_t i = 0; i < instant.size(); ++i) pose->push_back(Vec3f(instant[i]));
  ArraySamples still;
  still.samples.push_back({0.0, *pose});
  return PointMotion{ArrayTrack(still), kPoints, "the topology changes: the frame's pose is held", true,
                     pose};
}

// A blocked sample has none; USD holds what it has there.
void warn_of_counts(const MeshInput& input, std::size_t count, PrimLog& log) {
  const auto other = std::ranges::find_if(
      input.points.samples, [&](const ArraySample& sample) { return sample.values.size() != count; });
  log.warn(kPoints,
           message("found ", other->values.size(), " values ", at_shutter_time(other->time01), ", expected ",
                   count, " as at the frame; the nearest sample with as many is held there"));
}

std::string sampled_rule(const MeshInput& input, const ArrayTrack& track) {
  if (track.is_still()) return "still";
  if (input.computed_points) return "computed points, interpolated between samples";
  return track.held() ? "samples held until the next"
                      : "samples interpolated, those that bracket the shutter included";
}

}  // namespace

std::optional<PointMotion> point_motion(const MeshInput& input, PrimLog& log) {
  if (!check_times(times_of(input.points).times01, kPoints, log)) return std::nullopt;
  const Carriers carriers = carriers_of(input, log);
  if (!carriers.velocities.empty()) return carried(input, carriers, log);

  const std::size_t base = base_sample(times_of(input.points), input.time_remap.frame01);
  const std::size_t count = input.points.samples[base].values.size();
  const ArraySamples fitting = samples_of_size(input.points, base, count);
  if (input.topology_varies) return held_at_frame(input, fitting, log);
  if (fitting.samples.size() < input.points.samples.size()) warn_of_counts(input, count, log);
  if (!check_array(fitting, kPoints, log)) return std::nullopt;
  const ArrayTrack track(fitting);
  return PointMotion{track, kPoints, sampled_rule(input, track)};
}

}  // namespace msbvh::translate
