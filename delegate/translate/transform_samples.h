// A transform over the shutter as the front-end sampled it: double precision, interpolated by element between
// samples (smooth_times.h), or each sample held until the next.
#pragma once

#include <string>
#include <vector>

#include "core/base/affine.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/smooth_times.h"
#include "delegate/translate/time_layout.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {

// Drops the last column, which is (0, 0, 0, 1) for every matrix that maps points to points affinely.
Affine3d affine_from(const Matrix4d& row_vector_matrix);
// No element is NaN, infinite or larger than any coordinate may be (core/geometry).
bool is_representable(const Affine3d& map);
// Maps space to a plane, line or point, to the precision that floats keep of it: such a map has no inverse.
bool is_singular(const Affine3d& map);
// The same map between spaces whose origins are moved: p -> map(p + from) - to. This is where positions of
// any size become small enough for single precision.
Affine3d rebased(Affine3d map, const Vec3d& from, const Vec3d& to);

class TransformTrack {
 public:
  // Keeps what the shutter sees. `samples` must have passed check_transform().
  explicit TransformTrack(const TransformSamples& samples);
  explicit TransformTrack(const Affine3d& still);
  // Every sample rebased.
  TransformTrack rebased(const Vec3d& from, const Vec3d& to) const;

  // `within` is a time on the side of a jump that is meant.
  Affine3d at(double time01, double within) const;
  Affine3d at(double time01) const { return at(time01, time01); }
  // Compares values: a transform that does not change over many samples is still.
  bool is_still() const;
  bool is_singular_somewhere() const;
  const std::vector<double>& times01() const { return times01_; }
  const std::vector<Affine3d>& maps() const { return maps_; }
  std::vector<Breakpoint> breakpoints() const;
  double error_pixels() const { return error_pixels_; }
  const std::vector<double>& periods01() const { return periods01_; }

 private:
  std::vector<double> times01_;
  std::vector<Affine3d> maps_;
  SmoothTimes smooth_;
  std::vector<double> breakpoints01_;
  bool held_ = false;
  double error_pixels_ = 0.0;
  std::vector<double> periods01_;
};

// As many matrices as increasing times, all representable; a projective column is left out with a warning.
bool check_transform(const TransformSamples& samples, const std::string& attribute, PrimLog& log);

}  // namespace msbvh::translate
