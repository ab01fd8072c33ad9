// Sets of references seen over the whole shutter, for motion that is incoherent: where neighbours at the
// centre part on the way to its ends, a box at the centre says little of the boxes that rays meet.
//
// The area of a box between two linear keys is quadratic in time, so that Simpson's rule over open, centre
// and close is exact for one segment; for more it is a fair sample. Embree's LBBox carries the two ends
// likewise (kernels/common and builders/heuristic_binning_array_aligned.h of its public source).
#pragma once

#include <span>

#include "core/build/centre_pose.h"
#include "core/build/sah.h"

namespace msbvh {

struct MovingReference : Reference {  // its box is at the centre
  Box3f open, close;  // of the whole primitive, or of the fragment's moved corners; not conservative
};

// Boxes at three times, of three sets in the lanes of one area or of one set.
struct ShutterBox {
  Box4 centre, open, close;

  ShutterBox() = default;
  ShutterBox(const Box4& c, const Box4& o, const Box4& e) : centre(c), open(o), close(e) {}
  explicit ShutterBox(const MovingReference& r) : centre(r.box), open(r.open), close(r.close) {}
  void grow(const ShutterBox& b) {
    centre.grow(b.centre);
    open.grow(b.open);
    close.grow(b.close);
  }
  // Ordered by position, and by how far it moves; both twice over.
  __m128 position() const { return centre.sum(); }
  __m128 drift() const { return _mm_sub_ps(close.sum(), open.sum()); }
};

struct MovingBounds {
  ShutterBox box;
  Box4 positions, drifts;

  void grow(const ShutterBox& reference) {
    box.grow(reference);
    positions.grow(reference.position());
    drifts.grow(reference.drift());
  }
  void grow(const MovingBounds& other) {
    box.grow(other.box);
    positions.grow(other.positions);
    drifts.grow(other.drifts);
  }
};

// Mean half area over the shutter. In a tree of one linear segment a node's box is interpolated between its
// ends, also at the centre; with more there is a key of its own.
class MeanArea {
 public:
  explicit MeanArea(const Primitives& primitives);
  float operator()(const ShutterBox& b) const {
    return (half_area(b.open) + 4.0f * half_area(middle(b)) + half_area(b.close)) * (1.0f / 6.0f);
  }
  // Of three boxes, in lanes 0 to 2.
  __m128 operator()(const ShutterBox (&b)[3]) const {
    const __m128 ends = _mm_add_ps(half_areas(b[0].open, b[1].open, b[2].open),
                                   half_areas(b[0].close, b[1].close, b[2].close));
    const __m128 centre = half_areas(middle(b[0]), middle(b[1]), middle(b[2]));
    return _mm_mul_ps(_mm_add_ps(ends, _mm_mul_ps(centre, _mm_set1_ps(4.0f))), _mm_set1_ps(1.0f / 6.0f));
  }

 private:
  Box4 middle(const ShutterBox& b) const {
    if (!one_segment_) return b.centre;
    const __m128 half = _mm_set1_ps(0.5f);
    return {_mm_mul_ps(half, _mm_add_ps(b.open.lo, b.close.lo)),
            _mm_mul_ps(half, _mm_add_ps(b.open.hi, b.close.hi))};
  }

  bool one_segment_ = true;
};

// How what references stand for moves.
class ShutterPose {
 public:
  explicit ShutterPose(const CentrePose& pose);
  bool moving() const { return moving_; }
  const MeanArea& mean_area() const { return mean_area_; }
  MovingReference at_ends(const Reference& reference) const;
  // Whether the set grows much on its way, and neighbours in it move apart; by a sample.
  bool incoherent(std::span<const Reference> references) const;

 private:
  const CentrePose& pose_;
  MeanArea mean_area_;
  bool moving_;
};

}  // namespace msbvh
