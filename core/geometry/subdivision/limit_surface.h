// The limit surface of a cage, one face after the other: OpenSubdiv (Bfr) behind one door. No other file
// includes it. M. Niessner, C. Loop, M. Meyer, T. DeRose, "Feature-Adaptive GPU Rendering of Catmull-Clark
// Subdivision Surfaces", TOG 31(1), 2012.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/vec.h"
#include "core/geometry/subdivision/subdivision_mesh.h"

namespace msbvh {

class LimitSurface {
 public:
  // Borrows `cage`, which must be validated. Throws Error where OpenSubdiv refuses the topology. Until
  // prepare() it knows faces and edges alone.
  explicit LimitSurface(const Cage& cage);
  LimitSurface(const Cage& cage, std::uint32_t level) : LimitSurface(cage) { prepare(level); }
  // Of the same cage, which both share with what OpenSubdiv has made of its topology.
  LimitSurface(const LimitSurface& same, std::uint32_t level);
  // `level`: that of the finest points that will be asked for. Around extraordinary vertices OpenSubdiv
  // refines so many times and ends in an approximation (Gregory patches) that is exact at its corners. So
  // points i / 2^level along a face are exact; with OpenSubdiv's default of 2 they are off by 1 % of a face
  // (docs/design/subdivision.md).
  void prepare(std::uint32_t level);
  ~LimitSurface();

  std::uint32_t face_count() const;
  std::uint32_t edge_count() const;
  // False for holes and for faces that the boundary rule leaves without a surface.
  bool has_limit(std::uint32_t face) const;
  // Whether the surface has normals that differ across an edge or around a vertex: infinitely sharp ones
  // inside, a topology that is no manifold, or the bilinear scheme.
  bool has_creases() const;
  // Vertices wind so that the normal points out of the front, whatever the cage's handedness; edge i leads
  // from vertex i to the next.
  std::span<const int> face_vertices(std::uint32_t face) const;
  std::span<const int> face_edges(std::uint32_t face) const;
  std::uint32_t edge_start(std::uint32_t edge) const;  // of its two vertices, the first
  // Whether the surface ends or may bend there: a boundary, beside a face without a surface, a crease of any
  // sharpness, no manifold.
  bool is_sharp(std::uint32_t edge) const;
  // Whether the face's parameters are those of a single square; else it is cut into one square a vertex.
  bool is_quad(std::uint32_t face) const;

  const Cage& cage() const;
  // About what it keeps of faces around extraordinary vertices and sharp edges that it has evaluated.
  std::size_t irregular_bytes() const;

  struct Data;

 private:
  friend class FaceSurface;
  std::unique_ptr<Data> data_;
};

struct LimitPoint {
  Vec3d position, du, dv;
};

// How values of a cage are spread over its faces: as its points are, linearly between vertices, or by one of
// Cage::face_varying.
struct ValueKind {
  enum Kind : std::uint8_t { kVertex, kVarying, kFaceVarying } kind = kVertex;
  std::uint32_t channel = 0;  // of kFaceVarying
};

// One face's surface, of one kind of values. Not thread-safe; one each thread.
class FaceSurface {
 public:
  // The face must have a limit.
  FaceSurface(const LimitSurface& surface, std::uint32_t face, ValueKind kind = {});
  ~FaceSurface();

  // What is evaluated from now on: `width` numbers for each of the cage's values; positions have 3.
  void set_values(const float* values, std::uint32_t width);
  // (s, t) in the unit square `square` of the face: the whole face of a quad, else the quarter at that
  // vertex, with s along the edge that leaves the vertex (s = 1 is its middle) and t along the one that comes
  // in. `out` takes `width` numbers.
  void evaluate(std::uint32_t square, double s, double t, double* out) const;
  LimitPoint evaluate(std::uint32_t square, double s, double t) const;  // of positions

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh
