#include "delegate/translate/moving_array.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/base/lerp.h"
#include "core/base/parallel.h"
#include "core/geometry/triangle_mesh.h"
#include "core/motion/bezier.h"
#include "core/motion/bezier_fit.h"
#include "delegate/translate/blur.h"
#include "delegate/translate/box_corners.h"

namespace msbvh::translate {
namespace {

// Elements handled at a time by one thread: enough to amortise the hand-over, few enough to stop early.
constexpr std::size_t kGrain = 4096;

// What the stage says at one time.
struct PointInstant {
  Affine3d map;
  ArrayInstant values;
  Vec3d operator[](std::size_t i) const { return map.point(values[i]); }
};

PointInstant point_instant(const MovingArray& array, double time01, double within) {
  return {array.transform.at(time01, within), array.values.at(time01, within)};
}

struct Test {
  double w;  // in the segment
  PointInstant truth;
  ScreenInstant screen;
};

// A segment of a candidate's track: where it passes through the motion, and where it is compared.
struct TestedSegment {
  std::uint32_t degree;
  std::array<PointInstant, kMaxDegree + 1> nodes;
  std::vector<Test> tests;

  std::array<Vec3d, kMaxDegree + 1> controls(std::size_t i) const {
    std::array<Vec3d, kMaxDegree + 1> c;
    for (std::uint32_t k = 0; k <= degree; ++k) c[k] = nodes[k][i];
    controls_from_values([&](std::uint32_t k) -> Vec3d& { return c[k]; }, degree);
    return c;
  }
  // In pixels, at the tests.
  double deviation(std::size_t i) const {
    const auto c = controls(i);
    double worst = 0.0;
    for (const Test& test : tests) {
      const Vec3d truth = test.truth[i];
      const Vec3d track = bezier([&](std::uint32_t k) { return c[k]; }, degree, test.w);
      const double distance = length(truth - track);
      if (distance > 0.0) worst = std::max(worst, test.screen.at_point(distance, truth));
    }
    return worst;
  }
};

TestedSegment nodes_of(const MovingArray& points, const Candidate& track, std::uint32_t index) {
  const LayoutSegment segment = track.layout.segment(index);
  TestedSegment result{track.degree, {}, {}};
  const auto nodes = fit_nodes(track.degree);
  for (std::uint32_t k = 0; k <= track.degree; ++k) {
    result.nodes[k] = point_instant(points, segment.at(nodes[k]), segment.middle());
  }
  return result;
}

TestedSegment tested_segment(const MovingArray& points, const ScreenMeasure& measure, const Candidate& track,
                             std::uint32_t index, std::span<const Breakpoint> breakpoints,
                             std::span<const double> dense01) {
  const LayoutSegment segment = track.layout.segment(index);
  TestedSegment result = nodes_of(points, track, index);
  for (const double time01 : test_times01(segment, track.degree, breakpoints, dense01)) {
    const double w = (time01 - segment.begin01) / (segment.end01 - segment.begin01);
    const double within = track.layout.is_even() ? time01 : segment.middle();
    result.tests.push_back({w, point_instant(points, time01, within), measure.at(time01)});
  }
  return result;
}

// The largest of `deviation(i)`, or any value above `limit`.
template <typename Deviation>
double largest(std::size_t count, double limit, const Deviation& deviation) {
  std::vector<double> worst((count + kGrain - 1) / kGrain, 0.0);
  std::atomic<bool> exceeded = false;
  parallel_for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    double mine = 0.0;
    for (std::size_t i = begin; i < end && !exceeded.load(std::memory_order_relaxed); ++i) {
      mine = std::max(mine, deviation(i));
      if (mine > limit) exceeded.store(true, std::memory_order_relaxed);
    }
    worst[begin / kGrain] = mine;
  });
  return worst.empty() ? 0.0 : *std::ranges::max_element(worst);
}

double distance_of(const PointInstant& a, const PointInstant& b, const ScreenInstant& screen, std::size_t i) {
  const Vec3d truth = a[i];
  const double distance = length(truth - b[i]);
  return distance == 0.0 ? 0.0 : screen.at_point(distance, truth);
}

// From the pose at the shutter's centre.
double still_error(const MovingArray& points, const ScreenMeasure& measure,
                   std::span<const Breakpoint> breakpoints, std::span<const double> dense01, double limit) {
  const PointInstant centre = point_instant(points, 0.5, 0.5);
  std::vector<double> times01{0.0, 1.0, 0.25, 0.75, 0.113, 0.371, 0.629, 0.887};
  for (const Breakpoint& breakpoint : breakpoints) times01.push_back(breakpoint.time01);
  times01.insert(times01.end(), dense01.begin(), dense01.end());
  double worst = 0.0;
  for (const double time01 : times01) {
    const PointInstant other = point_instant(points, time01, time01);
    const ScreenInstant screen = measure.at(time01);
    worst = std::max(worst, largest(points.size(), limit,
                                    [&](std::size_t i) { return distance_of(other, centre, screen, i); }));
    if (worst > limit) break;
  }
  return worst;
}

// By how much a transform fails to repeat, at the corners of a box around the points.
double period_error(const MovingArray& points, const ScreenMeasure& measure, double period01,
                    std::span<const double> dense01, double limit) {
  const BoxCorners corners = corners_of(bounds({points.values, TransformTrack(Affine3d{})}));
  double worst = 0.0;
  const auto compare = [&](double time01) {
    const Affine3d truth = points.transform.at(time01);
    const Affine3d first = points.transform.at(time01 - period01 * std::floor(time01 / period01));
    const double distance = largest_distance(corners, truth, first);
    if (distance == 0.0) return;
    worst = std::max(worst, measure.at(time01).in_box(distance, bounds_of(corners, truth)));
  };
  compare(1.0);
  for (const double time01 : dense01) {
    if (worst > limit) break;
    if (time01 > period01) compare(time01);
  }
  return worst;
}

double track_error(const MovingArray& points, const ScreenMeasure& measure, const Candidate& track,
                   std::span<const Breakpoint> breakpoints, std::span<const double> dense01, double limit) {
  double repeated = 0.0;
  if (track.layout.repeats()) {
    repeated = period_error(points, measure, track.layout.period01(), dense01, limit);
    if (repeated > limit) return repeated;
  }
  const double allowed = limit - repeated;
  double worst = 0.0;
  for (std::uint32_t s = 0; s < track.layout.segments() && worst <= allowed; ++s) {
    if (!track.layout.segment(s).used) continue;
    const TestedSegment segment = tested_segment(points, measure, track, s, breakpoints, dense01);
    worst =
        std::max(worst, largest(points.size(), allowed, [&](std::size_t i) { return segment.deviation(i); }));
  }
  return repeated + worst;
}

// Of some of the points, evenly picked.
double track_blur(const MovingArray& points, const ScreenMeasure& measure, const Candidate& track) {
  constexpr std::size_t kMostPoints = 64;
  const std::size_t count = std::min(points.size(), kMostPoints);
  const auto picked = [&](std::size_t p) { return p * points.size() / count; };
  std::vector<TestedSegment> segments;
  for (std::uint32_t s = 0; s < track.layout.segments(); ++s) segments.push_back(nodes_of(points, track, s));
  std::vector<std::vector<Vec3d>> truth(count), shown(count);
  for (std::size_t t = 0; t < kBlurTimes; ++t) {
    const PlaceInLayout place = locate(track.layout, blur_time01(t));
    const PointInstant there = point_instant(points, blur_time01(t), blur_time01(t));
    for (std::size_t p = 0; p < count; ++p) {
      const auto c = segments[place.segment].controls(picked(p));
      truth[p].push_back(there[picked(p)]);
      shown[p].push_back(bezier([&](std::uint32_t k) { return c[k]; }, track.degree, place.w));
    }
  }
  const PointInstant centre = point_instant(points, 0.5, 0.5);
  double worst = 0.0;
  for (std::size_t p = 0; p < count; ++p) {
    worst = std::max(worst, measure.at(0.5).at_point(blur_distance(truth[p], shown[p]), centre[picked(p)]));
  }
  return worst;
}

// One time for all normals: brackets are found once.
struct NormalInstant {
  NormalInstant(const MovingArray& normals, const TimeLayout& layout, double local01) {
    const TimeLayout::Place place = layout.place(local01);
    const double within = layout.is_even() ? place.time01 : place.segment.middle();
    map = normals.transform.at(place.time01, within);
    values = normals.values.at(place.time01, within);
  }
  Vec3d operator[](std::size_t i) const { return normalize(transform_normal(map, values[i])); }
  Affine3d map;
  ArrayInstant values;
};

// Where linear keys are compared with the normals, in a span between two keys: thirds and quarters, and as
// densely as the transform is sampled there.
std::vector<double> normal_tests(std::span<const double> dense01, const TimeLayout& layout, double begin,
                                 double end) {
  std::vector<double> places{0.25, 0.5, 0.75};
  const LayoutSegment span{layout.place(begin).time01, layout.place(end).time01};
  const std::size_t dense = dense_inside(span, dense01).size();
  for (std::size_t i = 0; i < 2 * dense; ++i) places.push_back((double(i) + 0.5) / (2.0 * double(dense)));
  return places;
}

double normals_error(const MovingArray& normals, const TimeLayout& layout, std::uint32_t segments,
                     double limit) {
  const std::vector<double> dense01 = normals.dense_times01();
  double worst = 0.0;
  const std::uint32_t spans = std::max(segments, 1u);
  for (std::uint32_t s = 0; s < spans; ++s) {
    const double begin = double(s) / spans, end = double(s + 1) / spans;
    const NormalInstant a(normals, layout, segments == 0 ? 0.5 : begin);
    const NormalInstant b(normals, layout, segments == 0 ? 0.5 : end);
    std::vector<double> places = normal_tests(dense01, layout, begin, end);
    if (segments == 0) places.insert(places.end(), {0.0, 0.13, 0.37, 0.63, 0.87, 1.0});
    for (const double w : places) {
      const double local01 = (s + w) / spans;
      if (!layout.place(local01).segment.used) continue;
      const NormalInstant truth(normals, layout, local01);
      worst = std::max(worst, largest(normals.size(), limit, [&](std::size_t i) {
                         return length(truth[i] - normalize(lerp(a[i], b[i], w)));
                       }));
      if (worst > limit) return worst;
    }
  }
  return worst;
}

}  // namespace

std::vector<Breakpoint> MovingArray::breakpoints() const {
  std::vector<Breakpoint> result = values.breakpoints();
  const std::vector<Breakpoint> more = transform.breakpoints();
  result.insert(result.end(), more.begin(), more.end());
  return normalized_breakpoints(std::move(result));
}

std::vector<double> MovingArray::dense_times01() const {
  std::vector<double> result;
  if (transform.is_still()) return result;
  for (const double time01 : transform.times01()) {
    if (time01 >= 0.0 && time01 <= 1.0) result.push_back(time01);
  }
  return result;
}

Box3d bounds(const Box3d& box, const TransformTrack& transform) {
  Box3d result;
  for (const Affine3d& map : transform.maps()) result.grow(bounds_of(corners_of(box), map));
  return result;
}

Box3d bounds(const MovingArray& points) {
  Box3d box;
  for (const double time01 : points.values.extreme_times01()) {
    const ArrayInstant values = points.values.at(time01);
    for (std::size_t i = 0; i < values.size(); ++i) box.grow(values[i]);
  }
  return bounds(box, points.transform);
}

PointFit fit_points(const MovingArray& points, const ScreenMeasure& measure, const FitSettings& settings) {
  PointFit result;
  if (points.is_still()) return result;
  const std::vector<Breakpoint> breakpoints = points.breakpoints();
  const std::vector<double> dense01 = points.dense_times01();
  const double still_limit = kStillShare * settings.tolerance;
  result.error = still_error(points, measure, breakpoints, dense01, still_limit);
  if (result.error <= still_limit) return result;
  const double sampling = points.transform.error_pixels();
  const double tolerance = std::max(settings.tolerance - sampling, 0.5 * settings.tolerance);
  // Points that move on their own do not repeat with the transform.
  const std::vector<double> no_periods;
  std::vector<Candidate> tracks =
      candidates(breakpoints, settings, points.values.is_still() ? points.transform.periods01() : no_periods);
  const CandidateFit fit = cheapest_candidate(
      tracks, tolerance,
      [&](std::size_t i, double limit) {
        return track_error(points, measure, tracks[i], breakpoints, dense01, limit);
      },
      [&](std::size_t i) { return track_blur(points, measure, tracks[i]); });
  return {std::move(tracks[fit.index]), fit.error + sampling};
}

std::vector<Vec3f> point_controls(const MovingArray& points, const Candidate& track) {
  const std::size_t count = points.size();
  std::vector<Vec3f> out(count * track.form().controls() + TriangleMesh::kGuard);
  const auto for_all = [&](const auto& body) {
    parallel_for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  };
  if (track.layout.segments() == 0) {
    const PointInstant centre = point_instant(points, 0.5, 0.5);
    for_all([&](std::size_t i) { out[i] = Vec3f(centre[i]); });
  }
  for (std::uint32_t s = 0; s < track.layout.segments(); ++s) {
    Vec3f* first = out.data() + std::size_t(s) * track.degree * count;
    if (!track.layout.segment(s).used) {  // never seen, but it counts among the bounds
      for (std::uint32_t k = 1; k <= track.degree; ++k) std::copy(first, first + count, first + k * count);
      continue;
    }
    const TestedSegment segment = nodes_of(points, track, s);
    for_all([&](std::size_t i) {
      const auto c = segment.controls(i);
      for (std::uint32_t k = 0; k <= track.degree; ++k) first[k * count + i] = Vec3f(c[k]);
    });
  }
  return out;
}

Fit fit_normals(const MovingArray& normals, const TimeLayout& layout, const FitSettings& settings) {
  if (normals.is_still()) return {};
  return fewest_segments(settings, [&](std::uint32_t segments, double limit) {
    return normals_error(normals, layout, segments, limit);
  });
}

std::vector<Vec3f> normal_keys(const MovingArray& normals, const TimeLayout& layout, std::uint32_t segments) {
  const std::size_t count = normals.size();
  std::vector<Vec3f> keys(count * key_count(segments));
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    const NormalInstant instant(normals, layout, key_time(key, segments));
    Vec3f* out = keys.data() + count * key;
    parallel_for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = Vec3f(instant[i]);
    });
  }
  return keys;
}

}  // namespace msbvh::translate
