// The limit surface of a cage, one face after the other: OpenSubdiv (Bfr) behind one door. No other file
// includes it. M. Niessner, C. Loop, M. Meyer, T. DeRose, "Feature-Adaptive GPU Rendering of Catmull-Clark
// Subdivision Surfaces", TOG 31(1), 2012.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/base/vec.h"
#include "core/geometry/subdivision_mesh.h"

namespace msbvh {

class LimitSurface {
 public:
  // Borrows `mesh`, which must be validated. Throws Error where OpenSubdiv refuses the topology.
  //
  // `level`: that of the finest points that will be asked for. Around extraordinary vertices OpenSubdiv
  // refines so many times and ends in an approximation (Gregory patches) that is exact at its corners. So
  // points i / 2^level along a face are exact; with OpenSubdiv's default of 2 they are off by 1 % of a face
  // (docs/design/subdivision.md).
  LimitSurface(const SubdivisionMesh& mesh, std::uint32_t level);
  ~LimitSurface();

  std::uint32_t face_count() const;
  std::uint32_t edge_count() const;
  // False for holes and for faces that the boundary rule leaves without a surface.
  bool has_limit(std::uint32_t face) const;
  // Vertices wind so that the normal points out of the front, whatever the cage's handedness; edge i leads
  // from vertex i to the next.
  std::span<const int> face_vertices(std::uint32_t face) const;
  std::span<const int> face_edges(std::uint32_t face) const;
  std::uint32_t edge_start(std::uint32_t edge) const;  // of its two vertices, the first
  // Whether the face's parameters are those of a single square; else it is cut into one square a vertex.
  bool is_quad(std::uint32_t face) const;

  const SubdivisionMesh& mesh() const;

  struct Data;

 private:
  friend class FaceSurface;
  std::unique_ptr<Data> data_;
};

struct LimitPoint {
  Vec3d position, du, dv;
};

// One face's surface at one control of the cage's track at a time. Not thread-safe; one each thread.
class FaceSurface {
 public:
  // The face must have a limit.
  FaceSurface(const LimitSurface& surface, std::uint32_t face);
  ~FaceSurface();

  void set_control(std::uint32_t control);
  // (s, t) in the unit square `square` of the face: the whole face of a quad, else the quarter at that
  // vertex, with s along the edge that leaves the vertex (s = 1 is its middle) and t along the one that comes
  // in.
  LimitPoint evaluate(std::uint32_t square, double s, double t) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh
