#include "delegate/translate/transform_samples.h"

#include <algorithm>
#include <cmath>

#include "core/base/lerp.h"
#include "core/geometry/triangle_mesh.h"
#include "delegate/translate/translator.h"

namespace msbvh::translate {
namespace {

// Six digits: the determinant of a float matrix is noise below that share of the product of its columns'
// lengths.
constexpr double kSingular = 1e-6;

// What rounding leaves in the last column of a matrix that was multiplied, inverted, or stored in single
// precision: the point at distance 1 moves by less than that share of the distance.
constexpr double kAffineRounding = 1e-6;

bool is_affine(const Matrix4d& m) {
  const double largest = std::max({std::abs(m[3]), std::abs(m[7]), std::abs(m[11]), std::abs(m[15] - 1.0)});
  return largest <= kAffineRounding;
}

}  // namespace

Affine3d affine_from(const Matrix4d& m) {
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

bool is_representable(const Affine3d& map) {
  for (const Vec3d* column : {&map.x, &map.y, &map.z, &map.t}) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs((*column)[axis]) <= double(kMaxCoordinate))) return false;  // NaN too
    }
  }
  return true;
}

bool is_singular(const Affine3d& map) {
  const double volume = length(map.x) * length(map.y) * length(map.z);
  return !(std::abs(map.determinant()) > kSingular * volume);
}

Affine3d rebased(Affine3d map, const Vec3d& from, const Vec3d& to) {
  map.t = map.point(from) - to;
  return map;
}

TransformTrack::TransformTrack(const TransformSamples& samples)
    : smooth_({}, {}, false),
      breakpoints01_(samples.breakpoints01.value_or(samples.times01)),
      held_(samples.held),
      error_pixels_(samples.error_pixels),
      periods01_(samples.periods01) {
  const SampleRange range = samples_of_shutter(samples.times01, held_);
  for (std::size_t i = range.first; i <= range.last; ++i) {
    times01_.push_back(samples.times01[i]);
    maps_.push_back(affine_from(samples.matrices[i]));
  }
  smooth_ = SmoothTimes(times01_, samples.breakpoints01, held_);
}

TransformTrack::TransformTrack(const Affine3d& still)
    : times01_{0.0}, maps_{still}, smooth_(times01_, {}, false) {}

TransformTrack TransformTrack::rebased(const Vec3d& from, const Vec3d& to) const {
  TransformTrack result = *this;
  for (Affine3d& map : result.maps_) map = translate::rebased(map, from, to);
  return result;
}

Affine3d TransformTrack::at(double time01, double within) const {
  return mixed(smooth_.at(time01, within), [&](std::size_t i) { return maps_[i]; });
}

bool TransformTrack::is_still() const {
  return std::all_of(maps_.begin(), maps_.end(), [&](const Affine3d& map) { return map == maps_.front(); });
}

std::vector<Breakpoint> TransformTrack::breakpoints() const {
  std::vector<Breakpoint> result;
  if (is_still()) return result;
  for (const double time01 : breakpoints01_) result.push_back({time01, held_});
  return normalized_breakpoints(std::move(result));
}

bool TransformTrack::is_singular_somewhere() const {
  return std::any_of(maps_.begin(), maps_.end(), [](const Affine3d& map) { return is_singular(map); });
}

bool check_transform(const TransformSamples& samples, const std::string& attribute, PrimLog& log) {
  if (!check_times(samples.times01, attribute, log)) return false;
  if (samples.matrices.size() != samples.times01.size()) {
    return log.reject(attribute,
                      message("found ", samples.matrices.size(), " matrices; expected one for each of ",
                              samples.times01.size(), " times"));
  }
  bool projective = false;
  for (std::size_t i = 0; i < samples.matrices.size(); ++i) {
    if (!is_representable(affine_from(samples.matrices[i]))) {
      return log.reject(attribute,
                        message("the matrix ", at_shutter_time(samples.times01[i]),
                                " has an element that is not finite or too large; expected finite numbers",
                                " of at most 2^60 in size"));
    }
    projective = projective || !is_affine(samples.matrices[i]);
  }
  if (projective) {
    log.warn(attribute,
             "found a projective matrix; expected the last column 0, 0, 0, 1, which is taken instead");
  }
  return true;
}

}  // namespace msbvh::translate
