// What camera rays can reach, over the whole shutter.
//
// A point that such a ray meets lies, in camera space, before the lens and between the planes through the
// window's sides: perspective, at depth d = -z,  x <= right d + r |1 - d / f|  for a lens of radius r that is
// focused at f; orthographic, x <= right. Each is a few half-spaces n . p <= c. In the world, where the
// camera is a Bezier curve of affine maps A(t) with the eye e(t), the same half-space is
//
//   cof(A(t)) n . (p - e(t)) <= c det A(t)         (cof(A) = det(A) A^-T; both sides negated where det A < 0)
//
// a polynomial in t. In the Bernstein basis of a segment each coefficient is a half-space of the world, and
// the polynomial lies between the least and the largest (G. Farin, Curves and Surfaces for CAGD, 5th ed.,
// section 6.1): what is beyond all of them is beyond the plane throughout the segment. Window, lens and
// clipping range count with their widest in the segment. So the answer needs no sampling in time and is exact
// for the rays that the renderer makes, but for rounding, for which there is View::kMargin.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/box.h"
#include "core/scene/camera.h"

namespace msbvh::translate {

class ViewVolume {
 public:
  ViewVolume() = default;  // of no camera: misses everything
  // `camera` in the frame's world, as it is rendered.
  ViewVolume(const Camera& camera, std::uint32_t width, std::uint32_t height);

  // True only where no camera ray meets anything in the box at any time of the shutter.
  bool misses(const Box3d& box) const;

 private:
  struct HalfSpace {
    Vec3d normal;
    double offset;
    bool contains(const Box3d& box) const;
  };
  // What is in all of them is beyond one side of the picture.
  using Side = std::vector<HalfSpace>;
  using Segment = std::vector<Side>;

  std::vector<Segment> segments_;
};

}  // namespace msbvh::translate
