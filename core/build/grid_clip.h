// Parts of a grid's patch inside a box at the shutter's centre: partial primitives of patches.
//
// The paper bounds a patch's elements, clips the boxes and takes their union. Here the elements' triangles
// are clipped (core/build/clip.h): the parts are material, so that they bound the patch at every key and not
// at the centre alone, and those that lie inside cost no clipping.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "core/build/clip.h"
#include "core/build/reference.h"

namespace msbvh {

// A patch's points at one time.
class CentrePatch {
 public:
  CentrePatch(const GridMesh& mesh, const GridPatch& patch, float centre);

  std::uint32_t quads() const { return std::uint32_t(patch_.rows) * patch_.columns; }
  Box3f quad_box(std::uint32_t quad) const;  // row by row

  // What lies inside the box (grown by kClipError), triangle by triangle: the triangle, and the polygon on
  // it, or null for the whole.
  using Visitor = std::function<void(const GridTriangle&, const BarycentricPolygon*)>;
  void visit(const Box3f& box, const Visitor& visit) const;

  // The smallest window of the patch's quads that holds what lies inside the box. The whole patch where
  // nothing is inside.
  GridPatch window(const Box3f& box) const;

  std::array<Vec3d, 3> corners(const GridTriangle& triangle) const;

 private:
  const Vec3f& point(std::uint32_t row, std::uint32_t column) const {
    return points_[row * (kPatchQuads + 1) + column];
  }

  GridPatch patch_;
  std::array<Vec3f, (kPatchQuads + 1) * (kPatchQuads + 1)> points_;
};

// At the shutter's centre, or the slice's, of the frame that fragments were cut in.
CentrePatch centre_patch(const Primitives& primitives, const Reference& reference);

// As of a triangle (core/build/clip.h): tight boxes of the parts inside `box` on either side of a plane.
CutBounds cut_bounds(const CentrePatch& patch, const Box3f& box, int axis, float plane);

}  // namespace msbvh
