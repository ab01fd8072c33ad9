// One square of a face as it is drawn, and the places between its points where its triangles are held against
// the surface: half way along their edges, and their middles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/subdivision/face_lattice.h"
#include "delegate/translate/stray/stray.h"

namespace msbvh::translate {

class SquarePlaces {
 public:
  // Square `own` of the face. Borrows it.
  SquarePlaces(const LimitSurface& surface, std::uint32_t face, const SquareLattice& square,
               std::uint32_t own);

  // The square's points and what lies half way between them, as a lattice of twice its rate; no ids.
  const SquareLattice& halves() const { return halves_; }
  // Of the triangles, in their order.
  const std::vector<FacePoint>& middles() const { return middles_; }

  // Where things are at one time.
  struct Positions {
    std::vector<Vec3d> drawn;    // the square's points
    std::vector<Vec3d> halves;   // the surface there
    std::vector<Vec3d> middles;  // likewise; none: they are not looked at
  };
  // The square's points among halves().
  std::vector<Vec3d> points_of(const std::vector<Vec3d>& halves) const;
  void add_to(WorstStray& worst, const ScreenInstant& screen, const Positions& at) const;

 private:
  std::uint32_t row(std::uint32_t point) const { return point / (square_.columns + 1); }
  std::uint32_t column(std::uint32_t point) const { return point % (square_.columns + 1); }
  // Half way between two of the square's points.
  std::size_t half(std::uint32_t a, std::uint32_t b) const {
    return std::size_t(row(a) + row(b)) * (2 * square_.columns + 1) + column(a) + column(b);
  }
  // Whether the face's edge is sharp that two of the square's points lie on; nothing for what lies inside of
  // it.
  std::optional<bool> side_is_sharp(std::uint32_t a, std::uint32_t b) const;
  template <typename Visit>
  void for_drawn(const std::vector<Vec3d>& points, const Visit& visit) const;
  // By half: how far the surface is off half way along an edge.
  std::vector<double> off_edges(const Positions& at) const;

  const SquareLattice& square_;
  std::array<bool, 4> sharp_;  // the face's edges along the first row, last column, last row, first column
  SquareLattice halves_;
  std::vector<FacePoint> middles_;
};

}  // namespace msbvh::translate
