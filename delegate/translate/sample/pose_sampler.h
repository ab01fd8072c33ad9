// How densely a skeleton's poses of a mesh are sampled over the shutter. Joints turn between their samples,
// so that points run on arcs: poses are sampled until straight lines between them follow.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/box.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/normals.h"
#include "delegate/translate/sample/motion_source.h"
#include "delegate/translate/sample/pixel_size.h"
#include "delegate/translate/sample/pose_source.h"
#include "delegate/translate/skinning.h"

namespace msbvh::translate {

// Poses are sampled at 2^2 intervals at least, and at as many as joints turn for (kTimesATurn), up to 2^10,
// or to what joints turn for.
inline constexpr int kCoarsestPoseLevel = 2, kFinestPoseLevel = 10;
// Of all poses of a mesh together, 800 MB: no finer level begins beyond it.
inline constexpr std::size_t kMostPosedPoints = std::size_t(1) << 26;
// Radians that a normal may stray between poses: half of what its track may.
inline constexpr double kPosedNormalTolerance = 0.5 * kNormalTolerance;

// Shared: a mesh keeps its poses while the sampler makes more of them.
using PosedArray = std::shared_ptr<const std::vector<Vec3f>>;
struct Pose {
  PosedArray points;   // [N], in the skeleton's space
  PosedArray normals;  // [M], of length 1 or 0; none without rest normals
};

struct PoseSamples {
  std::vector<double> times01;  // increasing; one: still
  std::vector<Pose> poses;
  bool held = false;    // each holds until the next
  bool follows = true;  // false: so many poses as it takes cannot be afforded
};

// How far skinned points in a box may stray between poses, in units of the space that `placed`, of which the
// first thing counts, places: kSamplingShare of the tolerance, the rest of which is the track's. NaN where
// the place is no number.
double pose_tolerance(const Box3d& box, const MotionSource& placed, const PixelSize& pixel_size,
                      double tolerance_pixels);

// Poses one mesh, at each time once, however often it is sampled.
class PoseSampler {
 public:
  // Spans must live as long as this. Without times, joints and weights, which the source has.
  explicit PoseSampler(SkinningInput mesh) : mesh_(std::move(mesh)) {}

  // Between the samples the straight line strays from the skeleton's pose by at most pose_tolerance() of the
  // box around all poses, measured at the middles of the sampling intervals. `held`: values jump from sample
  // to sample. Nothing where the mesh cannot be skinned: an error in the log, or said by the front-end.
  std::optional<PoseSamples> sample(const PoseSource& source, const MotionSource& placed,
                                    const PixelSize& pixel_size, double tolerance_pixels, bool held,
                                    PrimLog& log);

 private:
  using Times = std::vector<double>;

  std::optional<PoseSamples> posed_once(const PoseSource& source, PrimLog& log);
  std::optional<PoseSamples> held_samples(const PoseSource& source, Times times01, PrimLog& log);
  bool pose(const PoseSource& source, const Times& times01, const Times& read_at01, PrimLog& log);
  bool skin(const PoseSource& source, std::span<const double> times01, std::span<const double> read_at01,
            PrimLog& log);
  bool still(const Times& times01) const;
  bool follows(const Times& times01, const Times& finer01, double tolerance) const;
  Box3d box() const;
  PoseSamples samples(Times times01) const;

  SkinningInput mesh_;
  std::map<double, Pose> poses_;
};

}  // namespace msbvh::translate
