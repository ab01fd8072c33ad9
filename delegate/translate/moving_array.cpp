#include "delegate/translate/moving_array.h"

#include <algorithm>
#include <atomic>

#include "core/base/lerp.h"
#include "core/base/parallel.h"
#include "core/geometry/triangle_mesh.h"
#include "core/motion/track.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {
namespace {

// Elements handled at a time by one thread: enough to amortise the hand-over, few enough to stop early.
constexpr std::size_t kGrain = 4096;

struct PointInstant {
  Affine3d map;
  ArrayInstant values;
  Vec3d operator[](std::size_t i) const { return map.point(values[i]); }
};

struct NormalInstant {
  Affine3d map;
  ArrayInstant values;
  Vec3d operator[](std::size_t i) const { return normalize(transform_normal(map, values[i])); }
};

template <typename Instant>
Instant instant_at(const MovingArray& array, double time01) {
  return {array.transform.at(time01), array.values.at(time01)};
}

// The stage's answer at a time beside the two keys that a track interpolates there.
template <typename Instant>
struct Comparison {
  Instant truth, key0, key1;
  double w;
  ScreenInstant screen;

  Vec3d track(std::size_t i) const { return lerp(key0[i], key1[i], w); }
};

double deviation(const Comparison<PointInstant>& at, std::size_t i) {
  const Vec3d truth = at.truth[i];
  const double distance = length(truth - at.track(i));
  return distance == 0.0 ? 0.0 : at.screen.at_point(distance, truth);
}

double deviation(const Comparison<NormalInstant>& at, std::size_t i) {
  return length(at.truth[i] - normalize(at.track(i)));
}

template <typename Instant>
std::vector<Comparison<Instant>> comparisons(const MovingArray& array, const ScreenMeasure& measure,
                                             std::uint32_t segments) {
  std::vector<double> times01 = array.values.times01();
  const std::vector<double>& more = array.transform.times01();
  times01.insert(times01.end(), more.begin(), more.end());
  std::vector<Comparison<Instant>> result;
  for (const double time01 : test_times(times01, segments, array.values.held())) {
    const TrackTime at = locate_key(time01, segments);
    if (segments > 0 && (at.w == 0.0 || at.w == 1.0)) continue;  // at its keys a track is exact
    const std::uint32_t next = std::min(at.key + 1, segments);
    result.push_back({instant_at<Instant>(array, time01),
                      instant_at<Instant>(array, key_time(at.key, segments)),
                      instant_at<Instant>(array, key_time(next, segments)), at.w, measure.at(time01)});
  }
  return result;
}

template <typename Instant>
double largest_deviation(const MovingArray& array, const ScreenMeasure& measure, std::uint32_t segments,
                         double limit) {
  const std::vector<Comparison<Instant>> tests = comparisons<Instant>(array, measure, segments);
  const std::size_t count = array.size();
  std::vector<double> worst((count + kGrain - 1) / kGrain, 0.0);
  std::atomic<bool> exceeded = false;
  parallel_for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
    double mine = 0.0;
    for (const Comparison<Instant>& test : tests) {
      if (exceeded.load(std::memory_order_relaxed)) break;
      for (std::size_t i = begin; i < end; ++i) mine = std::max(mine, deviation(test, i));
      if (mine > limit) exceeded.store(true, std::memory_order_relaxed);
    }
    worst[begin / kGrain] = mine;
  });
  return worst.empty() ? 0.0 : *std::max_element(worst.begin(), worst.end());
}

template <typename Instant>
Fit fit_array(const MovingArray& array, const ScreenMeasure& measure, const FitSettings& settings) {
  if (array.is_still()) return {};
  return fewest_segments(settings, [&](std::uint32_t segments, double limit) {
    return largest_deviation<Instant>(array, measure, segments, limit);
  });
}

template <typename Instant>
std::vector<Vec3f> array_keys(const MovingArray& array, std::uint32_t segments, std::size_t guard) {
  const std::size_t count = array.size();
  std::vector<Vec3f> keys(count * key_count(segments) + guard);
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    const Instant instant = instant_at<Instant>(array, key_time(key, segments));
    Vec3f* out = keys.data() + count * key;
    parallel_for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) out[i] = Vec3f(instant[i]);
    });
  }
  return keys;
}

}  // namespace

Box3d bounds(const Box3d& box, const TransformTrack& transform) {
  Box3d result;
  for (const Affine3d& map : transform.maps()) result.grow(bounds_of(corners_of(box), map));
  return result;
}

Box3d bounds(const MovingArray& points) {
  Box3d box;
  for (const double time01 : points.values.times01()) {
    const ArrayInstant values = points.values.at(time01);
    for (std::size_t i = 0; i < values.size(); ++i) box.grow(values[i]);
  }
  return bounds(box, points.transform);
}

Fit fit_points(const MovingArray& points, const ScreenMeasure& measure, const FitSettings& settings) {
  return fit_array<PointInstant>(points, measure, settings);
}

Fit fit_normals(const MovingArray& normals, const FitSettings& settings) {
  const ScreenMeasure unused = ScreenMeasure::filled_by({}, 1, 1);
  return fit_array<NormalInstant>(normals, unused, settings);
}

std::vector<Vec3f> point_keys(const MovingArray& points, std::uint32_t segments) {
  return array_keys<PointInstant>(points, segments, TriangleMesh::kGuard);
}

std::vector<Vec3f> normal_keys(const MovingArray& normals, std::uint32_t segments) {
  return array_keys<NormalInstant>(normals, segments, 0);
}

}  // namespace msbvh::translate
