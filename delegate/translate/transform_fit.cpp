#include "delegate/translate/transform_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/motion/bezier.h"
#include "core/motion/bezier_fit.h"
#include "delegate/translate/blur.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

// Where it is seen whether anything moves at all, before the chain's dense times, from which nothing hides.
constexpr std::array kProbes{0.5, 0.0, 1.0, 0.25, 0.75, 0.113, 0.371, 0.629, 0.887};

// The four columns of a map as one value, for interpolation.
struct Columns {
  Affine3d m;
  Columns operator+(const Columns& b) const { return {{m.x + b.m.x, m.y + b.m.y, m.z + b.m.z, m.t + b.m.t}}; }
  Columns operator-(const Columns& b) const { return {{m.x - b.m.x, m.y - b.m.y, m.z - b.m.z, m.t - b.m.t}}; }
  Columns operator*(double s) const { return {{m.x * s, m.y * s, m.z * s, m.t * s}}; }
};

using SegmentControls = std::array<Columns, kMaxDegree + 1>;

// Two columns that are not parallel span a plane.
bool is_plane_at_least(const Affine3d& map) {
  return cross(map.x, map.y) != Vec3d{} || cross(map.y, map.z) != Vec3d{} || cross(map.z, map.x) != Vec3d{};
}

TransformFitter::Fate fate_of(const std::vector<Affine3d>& maps) {
  using Fate = TransformFitter::Fate;
  if (!std::ranges::all_of(maps, is_representable)) return Fate::kNotFinite;
  if (!std::ranges::all_of(maps, is_singular)) return Fate::kDrawn;
  return std::ranges::any_of(maps, is_plane_at_least) ? Fate::kFlat : Fate::kVanished;
}

double fit_tolerance(double tolerance, double sampling_error) {
  return std::max(tolerance - sampling_error, 0.5 * tolerance);
}

}  // namespace

TransformFitter::TransformFitter(const InstanceChain& chain, const MapTarget& target,
                                 const ScreenMeasure& measure, const FitSettings& settings)
    : chain_(chain),
      target_(target),
      corners_(corners_of(target.box)),
      measure_(measure),
      tolerance_(settings.tolerance),
      breakpoints_(chain.breakpoints()),
      dense01_(chain.is_still() ? std::vector<double>() : chain.dense_times01()),
      candidates_(chain.is_still() ? std::vector<Candidate>()
                                   : candidates(breakpoints_, settings, chain.periods01())),
      prepared_(candidates_.size()) {
  const auto add = [&](double time01) {
    probes_.push_back({chain_.at(time01, time01), measure_.at(time01)});
  };
  if (chain.is_still()) {
    add(0.5);
    return;
  }
  for (const double time01 : kProbes) add(time01);
  double before = 0.0;
  for (const Breakpoint& breakpoint : breakpoints_) {
    add(breakpoint.time01);
    add(0.5 * (before + breakpoint.time01));
    before = breakpoint.time01;
  }
  for (const double time01 : dense01_) dense_.push_back({chain_.at(time01, time01), measure_.at(time01)});
  for (const double period01 : chain.periods01()) add_period(period01);
}

void TransformFitter::add_period(double period01) {
  Period& period = periods_.emplace_back(Period{period01, {}});
  const auto add = [&](double time01) {
    const double place = time01 - period01 * std::floor(time01 / period01);
    period.echoes.push_back({chain_.at(time01, time01), chain_.at(place, place), measure_.at(time01)});
  };
  add(1.0);
  for (const Breakpoint& breakpoint : breakpoints_) add(breakpoint.time01);
  for (const double time01 : dense01_) {
    if (time01 > period01) add(time01);
  }
}

TrackForm TransformFitter::form(std::uint32_t track) const {
  return track == 0 ? TrackForm{} : candidates_[track - 1].form();
}

TimeRemap TransformFitter::time_remap(std::uint32_t track) const {
  return track == 0 ? TimeRemap{} : candidates_[track - 1].layout.time_remap();
}

const std::vector<TransformFitter::Segment>& TransformFitter::prepared(std::size_t candidate) const {
  Prepared& p = prepared_[candidate];
  std::call_once(p.once, [&] { prepare(candidate); });
  return p.segments;
}

void TransformFitter::prepare(std::size_t candidate) const {
  const auto& [layout, degree] = candidates_[candidate];
  for (std::uint32_t i = 0; i < layout.segments(); ++i) {
    const LayoutSegment segment = layout.segment(i);
    Segment out{segment.used, {}, {}};
    for (const double node : fit_nodes(degree)) {
      out.nodes.push_back(chain_.at(segment.at(node), segment.middle()));
    }
    const auto add = [&](double time01, std::size_t dense) {
      const double w = (time01 - segment.begin01) / (segment.end01 - segment.begin01);
      const double within = layout.is_even() ? time01 : segment.middle();
      out.tests.push_back({w, chain_.at(time01, within), measure_.at(time01), dense});
    };
    for (const double time01 : test_times01(segment, degree, breakpoints_, {})) add(time01, 0);
    if (segment.used) {
      const std::span<const double> dense = dense_inside(segment, dense01_);
      for (const double& time01 : dense) add(time01, std::size_t(&time01 - dense01_.data()));
    }
    prepared_[candidate].segments.push_back(std::move(out));
  }
}

Affine3d TransformFitter::map(const InstanceChain::Instant& instant, std::size_t instance) const {
  return rebased(instant.map(instance), target_.object_origin, target_.world_origin);
}

std::vector<Affine3d> TransformFitter::probe_maps(std::size_t instance) const {
  std::vector<Affine3d> maps;
  for (const Probe& probe : probes_) maps.push_back(map(probe.instant, instance));
  return maps;
}

double TransformFitter::still_error(std::size_t instance, const std::vector<Affine3d>& maps,
                                    double limit) const {
  double worst = 0.0;
  const auto compare = [&](const Affine3d& other, const ScreenInstant& screen) {
    if (other == maps[0]) return;
    const double deviation = largest_distance(corners_, other, maps[0]);
    if (deviation > 0.0) worst = std::max(worst, screen.in_box(deviation, bounds_of(corners_, other)));
  };
  for (std::size_t i = 1; i < maps.size() && worst <= limit; ++i) compare(maps[i], probes_[i].screen);
  const std::size_t stride = chain_.dense_stride(instance);
  for (std::size_t i = 0; i < dense_.size() && worst <= limit; i += stride) {
    compare(map(dense_[i].instant, instance), dense_[i].screen);
  }
  return worst;
}

double TransformFitter::period_error(std::size_t instance, double period01, double limit) const {
  const auto period = std::ranges::find(periods_, period01, &Period::period01);
  double worst = 0.0;
  for (const Echo& echo : period->echoes) {
    const Affine3d truth = map(echo.instant, instance);
    const double distance = largest_distance(corners_, truth, map(echo.first, instance));
    if (distance > 0.0) worst = std::max(worst, echo.screen.in_box(distance, bounds_of(corners_, truth)));
    if (worst > limit) break;
  }
  return worst;
}

// What a track in motion and its failure to repeat add up to.
double TransformFitter::error(std::size_t instance, std::size_t candidate, double limit) const {
  const TimeLayout& layout = candidates_[candidate].layout;
  const double repeated = layout.repeats() ? period_error(instance, layout.period01(), limit) : 0.0;
  return repeated > limit ? repeated : repeated + moving_error(instance, candidate, limit - repeated);
}

double TransformFitter::moving_error(std::size_t instance, std::size_t candidate, double limit) const {
  const std::uint32_t degree = candidates_[candidate].degree;
  const std::size_t stride = chain_.dense_stride(instance);
  double worst = 0.0;
  for (const Segment& segment : prepared(candidate)) {
    if (!segment.used) continue;
    SegmentControls controls;
    for (std::uint32_t i = 0; i <= degree; ++i) controls[i].m = map(segment.nodes[i], instance);
    controls_from_values([&](std::uint32_t i) -> Columns& { return controls[i]; }, degree);
    for (const Test& test : segment.tests) {
      if (test.dense % stride != 0) continue;
      const Affine3d truth = map(test.instant, instance);
      const Affine3d track = bezier([&](std::uint32_t i) { return controls[i].m; }, degree, test.w);
      const double deviation = largest_distance(corners_, truth, track);
      if (deviation == 0.0) continue;
      worst = std::max(worst, test.screen.in_box(deviation, bounds_of(corners_, truth)));
      if (worst > limit) return worst;
    }
  }
  return worst;
}

// Of many instances each is looked at less closely: together they make the picture.
const std::vector<InstanceChain::Instant>& TransformFitter::blur_instants() const {
  constexpr std::size_t kMany = 1024;
  std::call_once(blur_once_, [&] {
    const std::size_t count = chain_.count() > kMany ? kBlurTimes / 8 : kBlurTimes;
    for (std::size_t t = 0; t < count; ++t) blur_.push_back(chain_.at(blur_time01(t), blur_time01(t)));
  });
  return blur_;
}

double TransformFitter::blur(std::size_t instance, std::size_t candidate) const {
  const auto& [layout, degree] = candidates_[candidate];
  const std::vector<InstanceChain::Instant>& instants = blur_instants();
  std::vector<std::vector<Vec3d>> truth(corners_.size()), track(corners_.size());
  for (std::size_t t = 0; t < instants.size(); ++t) {
    const PlaceInLayout place = locate(layout, blur_time01(t));
    const Segment& segment = prepared(candidate)[place.segment];
    SegmentControls controls;
    for (std::uint32_t i = 0; i <= degree; ++i) controls[i].m = map(segment.nodes[i], instance);
    controls_from_values([&](std::uint32_t i) -> Columns& { return controls[i]; }, degree);
    const Affine3d shown = bezier([&](std::uint32_t i) { return controls[i].m; }, degree, place.w);
    const Affine3d there = map(instants[t], instance);
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      truth[c].push_back(there.point(corners_[c]));
      track[c].push_back(shown.point(corners_[c]));
    }
  }
  double worst = 0.0;
  for (std::size_t c = 0; c < corners_.size(); ++c)
    worst = std::max(worst, blur_distance(truth[c], track[c]));
  return probes_[0].screen.in_box(worst, bounds_of(corners_, map(probes_[0].instant, instance)));
}

TransformFitter::Verdict TransformFitter::judge(std::size_t instance) const {
  return judge(instance, tolerance_);
}

TransformFitter::Verdict TransformFitter::judge(std::size_t instance, double tolerance) const {
  const double fit_within = fit_tolerance(tolerance, target_.sampling_error_pixels);
  const std::vector<Affine3d> maps = probe_maps(instance);
  Verdict verdict;
  verdict.fate = fate_of(maps);
  if (verdict.fate != Fate::kDrawn || candidates_.empty()) return verdict;
  const double still = kStillShare * fit_within;
  verdict.error = still_error(instance, maps, still);
  if (verdict.error > still) {
    const CandidateFit fit = cheapest_candidate(
        candidates_, fit_within,
        [&](std::size_t candidate, double limit) { return error(instance, candidate, limit); },
        [&](std::size_t candidate) { return blur(instance, candidate); });
    verdict.track = std::uint32_t(fit.index + 1);
    verdict.error = fit.error;
  }
  verdict.error += target_.sampling_error_pixels;
  // Controls of curves lie up to five times as far out as the curve.
  const auto is_far = [](const Affine3d& m) {
    return !is_representable({m.x * 8.0, m.y * 8.0, m.z * 8.0, m.t * 8.0});
  };
  if (std::ranges::any_of(maps, is_far) && !has_representable_controls(instance, verdict.track)) {
    verdict.fate = Fate::kNotFinite;
  }
  return verdict;
}

bool TransformFitter::has_representable_controls(std::size_t instance, std::uint32_t track) const {
  std::vector<Affine3f> maps(form(track).controls());
  controls(instance, track, maps.data());
  return std::ranges::all_of(maps, [](const Affine3f& map) { return is_representable(Affine3d(map)); });
}

void TransformFitter::controls(std::size_t instance, std::uint32_t track, Affine3f* out) const {
  if (track == 0) {
    *out = Affine3f(map(probes_[0].instant, instance));
    return;
  }
  const std::uint32_t degree = candidates_[track - 1].degree;
  for (const Segment& segment : prepared(track - 1)) {
    if (!segment.used) {
      std::fill(out + 1, out + degree + 1, *out);  // never seen, but it counts among the bounds
    } else {
      SegmentControls controls;
      for (std::uint32_t i = 0; i <= degree; ++i) controls[i].m = map(segment.nodes[i], instance);
      controls_from_values([&](std::uint32_t i) -> Columns& { return controls[i]; }, degree);
      for (std::uint32_t i = 0; i <= degree; ++i) out[i] = Affine3f(controls[i].m);
    }
    out += degree;
  }
}

}  // namespace msbvh::translate
