#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "core/geometry/triangle_mesh.h"
#include "core/motion/bezier.h"
#include "core/motion/bezier_fit.h"
#include "delegate/translate/displace/displaced_surface.h"

namespace msbvh::translate {
namespace {

double largest_distance(const std::vector<Vec3d>& truth, const std::vector<Vec3d>& track,
                        const ScreenInstant& screen) {
  double worst = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double distance = length(truth[i] - track[i]);
    if (distance > 0.0) worst = std::max(worst, screen.at_point(distance, truth[i]));
  }
  return worst;
}

// Where a segment of a track passes through the motion; `at(time01, within)` are places of the points.
template <typename At>
std::vector<std::vector<Vec3d>> controls_of(const Candidate& track, const LayoutSegment& segment,
                                            const At& at) {
  const auto nodes = fit_nodes(track.degree);
  std::vector<std::vector<Vec3d>> controls;
  for (std::uint32_t k = 0; k <= track.degree; ++k)
    controls.push_back(at(segment.at(nodes[k]), segment.middle()));
  for (std::size_t i = 0; i < controls.front().size(); ++i)
    controls_from_values([&](std::uint32_t k) -> Vec3d& { return controls[k][i]; }, track.degree);
  return controls;
}

class Fitter {
 public:
  Fitter(const DisplacedSurface& surface, const ScreenMeasure& measure)
      : surface_(surface),
        measure_(measure),
        breakpoints_(surface.breakpoints()),
        dense01_(surface.dense_times01()) {}

  const std::vector<Breakpoint>& breakpoints() const { return breakpoints_; }
  // From the pose at the shutter's centre.
  double still_error(double limit) const;
  double error(const Candidate& track, double limit) const;

 private:
  std::vector<Vec3d> at(double time01, double within) const { return surface_.picked_at(time01, within); }

  const DisplacedSurface& surface_;
  const ScreenMeasure& measure_;
  std::vector<Breakpoint> breakpoints_;
  std::vector<double> dense01_;
};

double Fitter::still_error(double limit) const {
  const std::vector<Vec3d> centre = at(0.5, 0.5);
  std::vector<double> times01{0.0, 1.0, 0.25, 0.75, 0.113, 0.371, 0.629, 0.887};
  for (const Breakpoint& breakpoint : breakpoints_) times01.push_back(breakpoint.time01);
  times01.insert(times01.end(), dense01_.begin(), dense01_.end());
  double worst = 0.0;
  for (const double time01 : times01) {
    worst = std::max(worst, largest_distance(at(time01, time01), centre, measure_.at(time01)));
    if (worst > limit) break;
  }
  return worst;
}

double Fitter::error(const Candidate& track, double limit) const {
  double worst = 0.0;
  for (std::uint32_t s = 0; s < track.layout.segments(); ++s) {
    const LayoutSegment segment = track.layout.segment(s);
    if (!segment.used) continue;
    const auto controls =
        controls_of(track, segment, [&](double time01, double within) { return at(time01, within); });
    for (const double time01 : test_times01(segment, track.degree, breakpoints_, dense01_)) {
      const double w = (time01 - segment.begin01) / (segment.end01 - segment.begin01);
      const std::vector<Vec3d> truth = at(time01, track.layout.is_even() ? time01 : segment.middle());
      std::vector<Vec3d> shown;
      for (std::size_t i = 0; i < truth.size(); ++i)
        shown.push_back(bezier([&](std::uint32_t k) { return controls[k][i]; }, track.degree, w));
      worst = std::max(worst, largest_distance(truth, shown, measure_.at(time01)));
      if (worst > limit) return worst;
    }
  }
  return worst;
}

// So many segments that cubic tracks have no more controls than allowed.
std::uint32_t segments_within(std::uint64_t most_controls, std::uint32_t max_segments) {
  const std::uint64_t most = most_controls > kMaxDegree ? (most_controls - 1) / kMaxDegree : 1;
  return std::uint32_t(std::min<std::uint64_t>(max_segments, std::bit_floor(most)));
}

}  // namespace

PointFit fit_displaced(const DisplacedSurface& surface, const ScreenMeasure& measure,
                       const FitSettings& settings, std::uint64_t most_controls) {
  PointFit result;
  if (surface.is_still()) return result;
  const Fitter fitter(surface, measure);
  const double still_limit = kStillShare * settings.tolerance;
  result.error = fitter.still_error(still_limit);
  if (result.error <= still_limit) return result;
  FitSettings allowed = settings;
  allowed.max_segments = segments_within(most_controls, settings.max_segments);
  allowed.choice.segments = std::min(allowed.choice.segments, allowed.max_segments);
  const double sampling = surface.error_pixels();
  const double tolerance = std::max(settings.tolerance - sampling, 0.5 * settings.tolerance);
  std::vector<Candidate> tracks = candidates(fitter.breakpoints(), allowed);
  const CandidateFit fit = cheapest_candidate(
      tracks, tolerance, [&](std::size_t i, double limit) { return fitter.error(tracks[i], limit); },
      [&](std::size_t i) { return fitter.error(tracks[i], std::numeric_limits<double>::infinity()); });
  return {std::move(tracks[fit.index]), fit.error + sampling};
}

std::vector<Vec3f> displaced_controls(const DisplacedSurface& surface, const Candidate& track) {
  const std::size_t count = surface.size();
  std::vector<Vec3f> out(count * track.form().controls() + TriangleMesh::kGuard);
  const auto write = [&](const std::vector<Vec3d>& points, std::size_t control) {
    for (std::size_t i = 0; i < count; ++i) out[control * count + i] = Vec3f(points[i]);
  };
  if (track.layout.segments() == 0) write(surface.at(0.5, 0.5), 0);
  for (std::uint32_t s = 0; s < track.layout.segments(); ++s) {
    const LayoutSegment segment = track.layout.segment(s);
    const std::size_t first = std::size_t(s) * track.degree;
    if (!segment.used) {  // never seen, but it counts among the bounds
      for (std::uint32_t k = 1; k <= track.degree; ++k)
        std::copy_n(out.begin() + std::ptrdiff_t(first * count), count,
                    out.begin() + std::ptrdiff_t((first + k) * count));
      continue;
    }
    const auto controls =
        controls_of(track, segment, [&](double time01, double within) { return surface.at(time01, within); });
    for (std::uint32_t k = 0; k <= track.degree; ++k) write(controls[k], first + k);
  }
  return out;
}

}  // namespace msbvh::translate
