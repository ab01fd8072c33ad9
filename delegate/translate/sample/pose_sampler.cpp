#include "delegate/translate/sample/pose_sampler.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/base/stretch.h"
#include "delegate/translate/box_corners.h"
#include "delegate/translate/sample/even_times.h"
#include "delegate/translate/sample/sampler.h"
#include "delegate/translate/sample/stretches.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

// Roundings of single precision by which poses that are the same may differ: UsdSkel interpolates between
// equal rotations too.
constexpr float kStillRoundings = 4.0f;
// Directions between normals are divided by no less.
constexpr float kShortest = 1e-30f;
// So that a skeleton of no size has a tolerance.
constexpr double kSmallestStretch = 1e-30;

using Points = std::vector<Vec3f>;

float largest(const Points& points) {
  float largest = 0.0f;
  for (const Vec3f& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

bool is_near(const Points& a, const Points& b, float distance) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3f d = abs(a[i] - b[i]);
    if (!(d.x <= distance && d.y <= distance && d.z <= distance)) return false;
  }
  return true;
}

// A time between two poses, with single-precision weights as the poses have it.
struct Between {
  double begin01, end01;
  float weight_begin, weight_end;
};

Between between(const std::vector<double>& times01, double time01) {
  const auto after = std::ranges::lower_bound(times01, time01);
  const double begin = *std::prev(after), end = *after, weight = (time01 - begin) / (end - begin);
  return {begin, end, float(1.0 - weight), float(weight)};
}

// How far the farthest value strays from the straight line; `unit`: from a line of directions. NaN where any
// does.
float strays(const Between& place, const Points& begin, const Points& end, const Points& values, bool unit) {
  float most = 0.0f;
  for (std::size_t i = 0; i < values.size(); ++i) {
    Vec3f straight = begin[i] * place.weight_begin + end[i] * place.weight_end;
    if (unit) {
      const float size = std::max(length(straight), kShortest);
      straight = {straight.x / size, straight.y / size, straight.z / size};
    }
    const float off = length(values[i] - straight);
    if (std::isnan(off)) return off;
    most = std::max(most, off);
  }
  return most;
}

// Those finite among the points.
void grow(Box3d& box, const Points& points) {
  for (const Vec3f& point : points) {
    if (is_finite(point)) box.grow(Vec3d(point));
  }
}

}  // namespace

double pose_tolerance(const Box3d& box, const MotionSource& placed, const PixelSize& pixel_size,
                      double tolerance_pixels) {
  std::vector<double> times01{0.0};
  if (!placed.still())
    times01 = dense_times01(Density::kGlance, placed.turns(0).rate(), placed.breakpoints01(), false);
  const std::uint32_t first = 0;
  std::vector<Matrix4d> places(times01.size());
  placed.evaluate(times01, std::span(&first, 1), places);
  const BoxCorners corners = corners_of(box.empty() ? Box3d{{}, {}} : box);
  Box3d around;
  double stretch = kSmallestStretch;
  for (const Matrix4d& place : places) {
    around.grow(bounds_of(corners, affine_from(place)));
    raise_to(stretch, largest_stretch(affine_from(place)));
  }
  return kSamplingShare * tolerance_pixels * pixel_size.at_box(around) / stretch;
}

std::optional<PoseSamples> PoseSampler::sample(const PoseSource& source, const MotionSource& placed,
                                               const PixelSize& pixel_size, double tolerance_pixels,
                                               bool held, PrimLog& log) {
  if (source.still()) return posed_once(source, log);
  const Times breakpoints01 = source.breakpoints01();
  if (held) return held_samples(source, breakpoints01, log);
  const int coarsest = std::max(kCoarsestPoseLevel, even_level(kTimesATurn * source.turns().rate()));
  Times times01 = even_times01(coarsest, breakpoints01);
  if (!pose(source, times01, times01, log)) return std::nullopt;
  if (still(times01)) return samples({times01.front()});
  const double tolerance = pose_tolerance(box(), placed, pixel_size, tolerance_pixels);
  for (int level = coarsest + 1; level <= kFinestPoseLevel; ++level) {
    Times finer01 = even_times01(level, breakpoints01);
    if (finer01.size() * mesh_.points.size() > kMostPosedPoints) break;
    if (!pose(source, finer01, finer01, log)) return std::nullopt;
    if (follows(times01, finer01, tolerance)) return samples(std::move(times01));
    times01 = std::move(finer01);
  }
  PoseSamples coarse = samples(std::move(times01));
  coarse.follows = false;
  return coarse;
}

std::optional<PoseSamples> PoseSampler::posed_once(const PoseSource& source, PrimLog& log) {
  const Times once01{0.0};
  if (!pose(source, once01, once01, log)) return std::nullopt;
  return samples({0.0});
}

std::optional<PoseSamples> PoseSampler::held_samples(const PoseSource& source, Times times01, PrimLog& log) {
  if (times01.empty() || times01.front() > 0.0) times01.insert(times01.begin(), 0.0);
  // In the middle of what holds: a time that is rounded might lie before its own sample.
  Times middles01;
  for (std::size_t i = 0; i < times01.size(); ++i)
    middles01.push_back(0.5 * (times01[i] + (i + 1 < times01.size() ? times01[i + 1] : 1.0)));
  if (!pose(source, times01, middles01, log)) return std::nullopt;
  if (still(times01)) return samples({times01.front()});
  PoseSamples held = samples(std::move(times01));
  held.held = true;
  return held;
}

// At those of the times that it has not been at; each is evaluated at its place in `read_at01`.
bool PoseSampler::pose(const PoseSource& source, const Times& times01, const Times& read_at01, PrimLog& log) {
  Times unknown01, unread01;
  for (std::size_t t = 0; t < times01.size(); ++t) {
    if (poses_.contains(times01[t])) continue;
    unknown01.push_back(times01[t]);
    unread01.push_back(read_at01[t]);
  }
  const std::span<const double> times = unknown01, reads = unread01;
  const std::size_t step = source.moves_rest() ? 1 : times.size();
  for (std::size_t t = 0; t < times.size(); t += step) {
    if (!skin(source, times.subspan(t, step), reads.subspan(t, step), log)) return false;
  }
  return true;
}

bool PoseSampler::skin(const PoseSource& source, std::span<const double> times01,
                       std::span<const double> read_at01, PrimLog& log) {
  PoseValues values;
  if (!source.evaluate(read_at01, values)) return false;
  SkinningInput input = mesh_;
  input.times01.assign(times01.begin(), times01.end());
  input.joints = values.joints;
  input.joint_count = values.joints.size() / times01.size();
  input.sub_shape_weights = values.weights;
  if (!values.rest.empty()) input.points = values.rest;
  std::optional<SkinnedArrays> skinned = skin_points(input, log);
  if (!skinned) return false;
  for (std::size_t t = 0; t < times01.size(); ++t) {
    Pose& pose = poses_[times01[t]];
    pose.points = std::make_shared<const Points>(std::move(skinned->points[t]));
    if (!skinned->normals.empty())
      pose.normals = std::make_shared<const Points>(std::move(skinned->normals[t]));
  }
  return true;
}

bool PoseSampler::still(const Times& times01) const {
  for (const PosedArray Pose::*array : {&Pose::points, &Pose::normals}) {
    const PosedArray& first = poses_.at(times01.front()).*array;
    if (!first) continue;
    const float rounding = kStillRoundings * std::numeric_limits<float>::epsilon() * largest(*first);
    const auto is_first = [&](double time01) {
      return is_near(*(poses_.at(time01).*array), *first, rounding);
    };
    if (!std::all_of(times01.begin() + 1, times01.end(), is_first)) return false;
  }
  return true;
}

// Whether straight lines between the poses stray from those at the finer times by no more than the tolerance,
// and normals by no more than theirs.
bool PoseSampler::follows(const Times& times01, const Times& finer01, double tolerance) const {
  for (const double time01 : finer01) {
    if (std::ranges::binary_search(times01, time01)) continue;
    const Between place = between(times01, time01);
    const Pose &begin = poses_.at(place.begin01), &end = poses_.at(place.end01), &pose = poses_.at(time01);
    if (double(strays(place, *begin.points, *end.points, *pose.points, false)) > tolerance) return false;
    if (pose.normals &&
        double(strays(place, *begin.normals, *end.normals, *pose.normals, true)) > kPosedNormalTolerance)
      return false;
  }
  return true;
}

// Around all poses so far.
Box3d PoseSampler::box() const {
  Box3d box;
  for (const auto& [time01, pose] : poses_) grow(box, *pose.points);
  return box;
}

PoseSamples PoseSampler::samples(Times times01) const {
  PoseSamples samples;
  for (const double time01 : times01) samples.poses.push_back(poses_.at(time01));
  samples.times01 = std::move(times01);
  return samples;
}

}  // namespace msbvh::translate
