// Spatial splits: a plane that cuts primitives in two. M. Stich, H. Friedrich, A. Dietrich, "Spatial Splits
// in Bounding Volume Hierarchies", HPG 2009, section 4; at the shutter's centre, as the MSBVH has them.
#pragma once

#include <limits>
#include <span>

#include "core/build/centre_pose.h"
#include "core/build/reference.h"
#include "core/build/sah.h"

namespace msbvh {

struct SpatialSplit {
  float cost = std::numeric_limits<float>::infinity();  // as ObjectSplit::cost
  int axis = 0;
  float plane = 0.0f;
  std::size_t left_count = 0, right_count = 0;
  Box3f left = {}, right = {};  // around the parts on either side, as the bins have them

  // How many of so many references it cuts, at most.
  std::size_t cuts(std::size_t references) const { return left_count + right_count - references; }
};

// The best of equally spaced planes across the longest axis of the set's box: looking along all three takes
// three times as long and finds worse trees, since cuts are spent on what soon needs them again. The parts of
// triangles between planes are found in single precision, since they only weigh candidates; instances are
// never cut and count on the side of their centre. With a stride only every so many-th reference is looked
// at.
SpatialSplit find_spatial_split(const CentrePose& pose, std::span<const Reference> references,
                                const Box4& box, std::size_t stride = 1);

// Cuts the references that lie on both sides, as long as there is room and unless it costs less to leave one
// whole on its centre's side (reference unsplitting, Stich et al. 2009, section 4.4): left parts take their
// place, right parts go behind `references`, `room` of them at most. Returns how many there are. What cannot
// be cut stays whole.
std::size_t cut_references(const CentrePose& pose, std::span<Reference> references, std::size_t room,
                           const SpatialSplit& split);

// The split's predicate, of parts as of what is whole: by the centre.
class IsLeftOfPlane {
 public:
  explicit IsLeftOfPlane(const SpatialSplit& split)
      : twice_(_mm_set1_ps(2.0f * split.plane)), axis_(split.axis) {}
  bool operator()(const Box4& box, const Reference&) const {
    return ((_mm_movemask_ps(_mm_cmplt_ps(box.sum(), twice_)) >> axis_) & 1) != 0;
  }

 private:
  const __m128 twice_;
  const int axis_;
};

}  // namespace msbvh
