#include "delegate/translate/transform_fit.h"

#include <algorithm>
#include <array>

#include "core/motion/bezier.h"
#include "core/motion/bezier_fit.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

// Where it is seen whether anything moves at all. Not even, so that no whole number of turns looks still.
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

double fit_tolerance(const FitSettings& settings, const MapTarget& target) {
  return std::max(settings.tolerance - target.sampling_error_pixels, 0.5 * settings.tolerance);
}

}  // namespace

TransformFitter::TransformFitter(const InstanceChain& chain, const MapTarget& target,
                                 const ScreenMeasure& measure, const FitSettings& settings)
    : chain_(chain),
      target_(target),
      corners_(corners_of(target.box)),
      measure_(measure),
      settings_(settings),
      bends_(chain.bends()),
      candidates_(chain.is_still() ? std::vector<Candidate>() : candidates(bends_, settings)),
      prepared_(candidates_.size()) {
  settings_.tolerance = fit_tolerance(settings, target);
  const auto add = [&](double time01) {
    probes_.push_back({chain_.at(time01, time01), measure_.at(time01)});
  };
  if (chain.is_still()) {
    add(0.5);
    return;
  }
  for (const double time01 : kProbes) add(time01);
  double before = 0.0;
  for (const Bend& bend : bends_) {
    add(bend.time01);
    add(0.5 * (before + bend.time01));
    before = bend.time01;
  }
}

TrackForm TransformFitter::form(std::uint32_t track) const {
  return track == 0 ? TrackForm{} : candidates_[track - 1].form();
}

Clock TransformFitter::clock(std::uint32_t track) const {
  return track == 0 ? Clock{} : candidates_[track - 1].layout.clock();
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
    for (const double time01 : test_times01(segment, degree, bends_)) {
      const double w = (time01 - segment.begin01) / (segment.end01 - segment.begin01);
      out.tests.push_back(
          {w, chain_.at(time01, layout.is_even() ? time01 : segment.middle()), measure_.at(time01)});
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

double TransformFitter::still_error(const std::vector<Affine3d>& maps) const {
  double worst = 0.0;
  for (std::size_t i = 1; i < maps.size(); ++i) {
    if (maps[i] == maps[0]) continue;
    const double deviation = largest_distance(corners_, maps[i], maps[0]);
    if (deviation > 0.0)
      worst = std::max(worst, probes_[i].screen.in_box(deviation, bounds_of(corners_, maps[i])));
  }
  return worst;
}

double TransformFitter::error(std::size_t instance, std::size_t candidate, double limit) const {
  const std::uint32_t degree = candidates_[candidate].degree;
  double worst = 0.0;
  for (const Segment& segment : prepared(candidate)) {
    if (!segment.used) continue;
    SegmentControls controls;
    for (std::uint32_t i = 0; i <= degree; ++i) controls[i].m = map(segment.nodes[i], instance);
    controls_from_values([&](std::uint32_t i) -> Columns& { return controls[i]; }, degree);
    for (const Test& test : segment.tests) {
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

TransformFitter::Verdict TransformFitter::judge(std::size_t instance) const {
  const std::vector<Affine3d> maps = probe_maps(instance);
  Verdict verdict;
  verdict.fate = fate_of(maps);
  if (verdict.fate != Fate::kDrawn || candidates_.empty()) return verdict;
  verdict.error = still_error(maps);
  if (verdict.error > kStillShare * settings_.tolerance) {
    const CandidateFit fit = cheapest_candidate(
        candidates_.size(), settings_.tolerance,
        [&](std::size_t candidate, double limit) { return error(instance, candidate, limit); });
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
