// How far each point of a mesh is displaced along its normal, over the shutter. A point has one distance,
// whatever the faces around it say: where texture coordinates have a seam, or materials meet, their mean. So
// what is closed stays closed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/displace/face_displacements.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/tessellation.h"

namespace msbvh::translate {

// Linear between times, held outside.
class PointDistances {
 public:
  // `values` at each of one or more increasing times, one a point.
  PointDistances(std::vector<double> times01, std::vector<std::vector<double>> values);

  bool is_still() const { return values_.size() == 1; }
  const std::vector<double>& times01() const { return times01_; }
  std::vector<double> at(double time01) const;
  double largest() const;

 private:
  std::vector<double> times01_;
  std::vector<std::vector<double>> values_;
};

// Of the points of `mesh`: of its refinement, or of its polygons. Textures are filtered over what lies
// between a point and its neighbours.
PointDistances point_distances(const MeshInput& input, const Tessellation& mesh,
                               const FaceDisplacements& displacements, PrimLog& log);

// Of any places of a refinement's faces, at one time, as each face itself says.
class PlaceDistances {
 public:
  // Borrows all three. What is wrong with them has been said by point_distances().
  PlaceDistances(const MeshInput& input, const Tessellation& mesh, const FaceDisplacements& displacements,
                 double time01);
  ~PlaceDistances();

  // One for each point of the squares, one square after the other; textures are filtered over what lies
  // between neighbours.
  void at_squares(std::uint32_t cage_face, std::span<const SquareLattice> squares, double* out) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh::translate
