// Catmull-Clark subdivision written out from its rules, without OpenSubdiv: what limit points are held
// against. E. Catmull, J. Clark, CAD 10(6), 1978; creases: T. DeRose, M. Kass, T. Truong, "Subdivision
// Surfaces in Character Animation", SIGGRAPH 1998; limit masks: M. Halstead, M. Kass, T. DeRose, SIGGRAPH
// 1993.
#pragma once

#include <array>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/geometry/subdivision/subdivision_mesh.h"

namespace msbvh::procedural {

class CatmullClark {
 public:
  // The cage's first control. Boundaries are creases; with kEdgeAndCorner, vertices of one face are corners.
  explicit CatmullClark(const SubdivisionMesh& cage);

  void refine();

  // Limit of each vertex by where it lies: (face, square, s, t) of the cage, with s and t in units of
  // 2^-level. Sharpness must have run down to 0, or be infinite.
  using Place = std::tuple<std::uint32_t, std::uint32_t, int, int>;
  std::map<Place, Vec3d> limits(int level) const;

 private:
  static constexpr double kInfinite = 10.0;  // as OpenSubdiv and USD have it
  using Edge = std::pair<int, int>;
  struct Face {
    std::vector<int> vertices;
    std::uint32_t base = 0, square = 0;
    std::vector<std::array<double, 2>> st;  // of the corners; empty for a cage's face that is no quad
  };
  struct Ring {
    std::vector<int> edges;                  // neighbours along edges
    std::vector<std::pair<int, int>> faces;  // face, corner in it
  };

  static Edge edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }
  static double less_sharp(double s) { return s >= kInfinite ? s : std::max(0.0, s - 1.0); }
  double sharpness(int a, int b) const;
  std::vector<Ring> rings() const;
  void find_edges();
  static Face child(const Face& f, int i, int centre, const std::map<Edge, int>& middle);
  Vec3d centre(const Face& f) const;
  int rule(int v, const Ring& ring, bool child) const;  // 0 smooth, 2 crease, 3 corner
  Vec3d vertex_by_rule(int v, const Ring& ring, int rule, bool child) const;
  double fraction(int v, const Ring& ring) const;
  Vec3d vertex_point(int v, const Ring& ring) const;
  Vec3d edge_point(const Edge& e) const;
  Vec3d limit(int v, const Ring& ring) const;

  std::vector<Vec3d> points_;
  std::vector<double> corners_;
  std::vector<Face> faces_;
  std::map<Edge, double> creases_;
  std::map<Edge, std::vector<int>> edge_faces_;
};

}  // namespace msbvh::procedural
