// A NURBS patch as polygons between points of its surface, at a grid of parameters. Which points there are is
// a matter of knots and cells; where they are is linear in the control points as long as weights hold, so
// that samples, velocities and accelerations are refined one by one, and the surface moves exactly as its
// control points do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/shape/nurbs_patch.h"

namespace msbvh::translate {

// The parameters of one direction that points lie at.
struct GridLines {
  std::vector<SplineStencil> stencils;
  // Where each lies among values that are linear between knots: after the value of that number, by a share.
  std::vector<std::uint32_t> segments;
  std::vector<double> shares;
  // The line whose places each has: itself, or that at the other side of a kink or a seam. Two of them, one
  // on another, keep normals apart.
  std::vector<std::uint32_t> places;
  std::vector<std::uint32_t> points;  // likewise, the line whose points each has
  struct Cell {
    std::uint32_t from, to, segment;
  };
  std::vector<Cell> cells;
};

// `poses`: of the control points, all those that are to be evaluated.
using ControlPoses = std::span<const std::span<const Vec3f>>;

class NurbsGrid {
 public:
  // Seams where the surface closes, and poles where a side of it has shrunk to a point, are closed: by one
  // point, or, `apart`, by several in one place, so that primvars may have several values there.
  NurbsGrid(const NurbsPatch& patch, const NurbsCells& cells, ControlPoses poses,
            std::span<const double> weights, bool apart);

  const std::vector<int>& counts() const { return counts_; }      // vertices a face
  const std::vector<int>& indices() const { return indices_; }    // counter-clockwise where u x v points
  const std::vector<int>& segments() const { return segments_; }  // of each face: what uniform values are for
  std::size_t point_count() const { return points_.size(); }
  const NurbsPatch& patch() const { return patch_; }

  // [point_count()][3], of points, velocities or accelerations of the control points.
  std::vector<float> positions(std::span<const float> values, std::span<const double> weights) const;
  // [point_count()][width], of one value a control point.
  std::vector<float> vertex_values(std::span<const float> values, std::size_t width,
                                   std::span<const double> weights) const;
  // The same of one value a crossing of knots, bilinear between them.
  std::vector<float> varying_values(std::span<const float> values, std::size_t width) const;

 private:
  struct Node {
    std::uint32_t u, v;  // lines
  };
  Node place_of(Node node) const;
  void make_faces(bool apart);

  NurbsPatch patch_;
  GridLines u_, v_;
  bool u_poles_[2], v_poles_[2];  // the first and the last line is a point
  std::vector<Node> points_;
  std::vector<int> counts_, indices_, segments_;
};

}  // namespace msbvh::translate
