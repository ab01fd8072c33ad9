// From a cage to triangles between points of its limit surface. Which points is a matter of the cage's
// topology and the rates of its edges alone; where they are is linear in the cage's values, so that tracks of
// any degree are refined control by control and move exactly as the surface does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry/grid_mesh.h"
#include "core/geometry/subdivision/face_lattice.h"
#include "core/geometry/subdivision/limit_surface.h"
#include "core/geometry/subdivision/refinable_cage.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {

// The same surface as grids, one a square of a face that is drawn.
struct GridLayout {
  std::vector<Grid> grids;            // of a still mesh; of the cage's faces
  std::vector<std::uint32_t> points;  // of each of GridMesh's points, which of the refined mesh's it is
};

class RefinedMesh {
 public:
  // `poses`: of the cage's vertices, for `level` to look at; each edge is asked for once, from several
  // threads. Where there would be more than `most_points`, all levels are lowered until there are not, or are
  // 0. Throws Error for a cage that is not valid or that OpenSubdiv refuses.
  RefinedMesh(Cage cage, std::span<const Vec3f* const> poses, const EdgeLevel& level,
              std::uint64_t most_points);
  RefinedMesh(std::shared_ptr<RefinableCage> cage, std::span<const Vec3f* const> poses,
              const EdgeLevel& level, std::uint64_t most_points);
  // `levels`: of this cage. What there is of the mesh does not depend on anything else.
  RefinedMesh(std::shared_ptr<RefinableCage> cage, EdgeLevels levels);

  const Cage& cage() const { return cage_->cage(); }
  std::uint32_t point_count() const { return point_count_; }
  // Vertices are points; counter-clockwise from outside whatever the cage's orientation is.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<std::uint32_t>& faces() const { return faces_; }  // the cage's face of each triangle
  std::uint32_t lowered() const { return lowered_; }                  // by how many levels
  // Whether normals differ across an edge or around a vertex: one a corner then, else one a point.
  bool has_creases() const { return creased_; }

  // Values of kVertex or kVarying at the points. `controls`: of the cage, [vertex_count][width] each; `out`,
  // one for each of them, takes [point_count()][width].
  void at_points(ValueKind kind, std::uint32_t width, std::span<const float* const> controls,
                 std::span<float* const> out) const;
  // Of any kind at the triangles' corners: [triangles().size()][3][width]. Of kFaceVarying `controls` have
  // the channel's [value_count][width].
  void at_corners(ValueKind kind, std::uint32_t width, std::span<const float* const> controls,
                  std::span<float* const> out) const;
  // Likewise at the points of grid_layout(), of the face that each is of.
  void at_grid_points(ValueKind kind, std::uint32_t width, std::span<const float* const> controls,
                      std::span<float* const> out) const;
  GridLayout grid_layout() const;
  // Unit normals of the limit surface, for a cage at `positions`: one a point, or one a corner where
  // has_creases(). Zero where the surface has none.
  std::vector<Vec3f> normals(const Vec3f* positions) const;

  // To evaluate faces with (FaceSurface).
  const LimitSurface& surface() const { return *surface_; }
  const std::vector<std::uint32_t>& drawn_faces() const { return drawn_; }  // of the cage
  std::uint32_t level() const { return level_; }                            // of the finest edge
  // Of a drawn face: its points, whose ids are not those of the mesh, and its triangles, in their order.
  std::vector<SquareLattice> squares_of(std::uint32_t face) const { return lattices_->squares(face); }
  // Those that a drawn face sees, each once; their ids are points.
  std::vector<FacePoint> points_of(std::uint32_t face) const;
  // One value a point, whatever the faces around it disagree on: the mean of what each says, in the order of
  // the faces. `at_face(face, squares, out)`, called from several threads, writes a value for each point of
  // the squares, one square after the other.
  using FaceValues = std::function<void(std::uint32_t, std::span<const SquareLattice>, double*)>;
  std::vector<double> means(const FaceValues& at_face) const;
  // The limit surface of a cage at `positions`. Normals are unit means of the faces' own, which differ at
  // creases; zero where there is none.
  struct LimitPoints {
    std::vector<Vec3d> positions, normals;
  };
  LimitPoints limit(const Vec3f* positions) const;
  std::size_t bytes() const;  // without the cage's

 private:
  struct Corner {
    std::uint32_t square, point;  // of SquareLattice::points
  };
  void own_borders();
  void make_triangles();
  template <typename Visit>
  void for_faces(const Visit& visit) const;
  template <typename Visit>
  void for_triangles(const std::vector<SquareLattice>& squares, const Visit& visit) const;
  template <typename Place, typename Out>
  void write_corners(const std::vector<SquareLattice>& squares, std::size_t width, const Place& at_place,
                     Out* to) const;
  template <typename Value>
  struct Said;
  template <typename Value, typename AtFace>
  std::vector<Said<Value>> said_by_faces(const AtFace& at_face) const;
  template <typename Evaluate>
  void evaluate_points(ValueKind kind, const Evaluate& evaluate) const;
  std::uint32_t point(std::uint32_t id) const {
    return id < lattices_->border_count() ? border_point_[id]
                                          : id - lattices_->border_count() + border_points_;
  }

  std::shared_ptr<RefinableCage> cage_;
  std::uint32_t level_;
  std::shared_ptr<const LimitSurface> surface_;  // as fine as the finest edge
  std::unique_ptr<const FaceLattices> lattices_;
  std::uint32_t lowered_;
  bool creased_;
  std::vector<std::uint32_t> drawn_;           // the faces that have a limit
  std::vector<std::uint32_t> first_triangle_;  // of each of them
  std::vector<std::uint32_t> border_owner_;    // of each border id, the first of drawn_ that sees it
  std::vector<std::uint32_t> border_point_;
  std::uint32_t border_points_ = 0, point_count_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> faces_;
};

}  // namespace msbvh
