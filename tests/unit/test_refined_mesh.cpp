// Triangles of limit surfaces: the same points as grids of them, closed at any rates, with the surface's own
// normals and values.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <doctest/doctest.h>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/stretch.h"
#include "core/geometry/subdivision/dice.h"
#include "core/geometry/subdivision/refined_mesh.h"
#include "tests/support/cages.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

constexpr std::uint64_t kPlenty = 1 << 24;

EdgeLevel everywhere(std::uint32_t level) {
  return [level](const CageEdge&) { return level; };
}
std::uint32_t uneven(const CageEdge& e) { return (e.a * e.b + e.a + e.b) % 4; }

std::vector<float> at_points(const RefinedMesh& mesh, const std::vector<float>& values, std::uint32_t width,
                             ValueKind kind = {}) {
  std::vector<float> out(std::size_t(mesh.point_count()) * width);
  const float* from[] = {values.data()};
  float* to[] = {out.data()};
  mesh.at_points(kind, width, from, to);
  return out;
}

std::vector<float> at_corners(const RefinedMesh& mesh, const std::vector<float>& values, std::uint32_t width,
                              ValueKind kind) {
  std::vector<float> out(3 * mesh.triangles().size() * width);
  const float* from[] = {values.data()};
  float* to[] = {out.data()};
  mesh.at_corners(kind, width, from, to);
  return out;
}

std::vector<Vec3f> positions(const RefinedMesh& mesh, const Vec3f* cage) {
  std::vector<Vec3f> out(mesh.point_count());
  const float* from[] = {&cage->x};
  float* to[] = {&out[0].x};
  mesh.at_points({}, 3, from, to);
  return out;
}

// Every directed edge once, and its opposite once.
bool is_closed(const RefinedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : mesh.triangles()) {
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  return std::ranges::all_of(edges, [&](const auto& edge) {
    const auto opposite = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && opposite != edges.end() && opposite->second == 1;
  });
}

double volume(const RefinedMesh& mesh, const std::vector<Vec3f>& p) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles())
    sum += dot(Vec3d(p[t[0]]), cross(Vec3d(p[t[1]]), Vec3d(p[t[2]]))) / 6.0;
  return sum;
}

// The cage wound the other way, and said to be.
Cage left_handed(Cage cage) {
  auto corner = cage.face_vertex_indices.begin();
  for (const std::uint32_t n : cage.face_vertex_counts) {
    std::reverse(corner, corner + n);
    corner += n;
  }
  cage.left_handed = true;
  return cage;
}

}  // namespace

TEST_CASE("points of a refined mesh are those of the grids, bit by bit") {
  for (const SubdivisionMesh& cage : {cube_cage(), prism_cage(5), prism_cage(3), sheet_cage(3, 4)}) {
    const GridMesh grids = dice(cage, {.level = 3});
    std::set<std::array<float, 3>> expected;
    for (const Grid& g : grids.grids) {
      for (std::uint32_t r = 0; r <= g.rows; ++r) {
        for (std::uint32_t c = 0; c <= g.columns; ++c) {
          const Vec3f p = grids.control_point(g, r, c, 0);
          expected.insert({p.x, p.y, p.z});
        }
      }
    }
    const RefinedMesh mesh(cage, {}, everywhere(3), kPlenty);
    std::set<std::array<float, 3>> found;
    for (const Vec3f& p : positions(mesh, cage.positions.data())) found.insert({p.x, p.y, p.z});
    CHECK(found == expected);
    CHECK(mesh.triangles().size() == grids.triangle_count());
  }
}

TEST_CASE("a closed cage stays closed at any rates, edges of one segment among them, and faces outwards") {
  for (const SubdivisionMesh& cage :
       {cube_cage(), prism_cage(3), prism_cage(5), prism_cage(7), octahedron_cage()}) {
    for (const EdgeLevel& level : {everywhere(0), everywhere(1), everywhere(2), EdgeLevel(uneven)}) {
      const RefinedMesh mesh(cage, {}, level, kPlenty);
      CHECK(is_closed(mesh));
      const double inside = volume(mesh, positions(mesh, cage.positions.data()));
      CHECK(inside > 0.1);
      const RefinedMesh mirrored(left_handed(cage), {}, level, kPlenty);
      CHECK(is_closed(mirrored));
      CHECK(volume(mirrored, positions(mirrored, cage.positions.data())) ==
            doctest::Approx(inside).epsilon(0.02));
    }
  }
}

TEST_CASE("quads at level 0 are two triangles between limit points of their vertices") {
  const SubdivisionMesh cage = cube_cage();
  const RefinedMesh mesh(cage, {}, everywhere(0), kPlenty);
  CHECK(mesh.triangles().size() == 12);
  CHECK(mesh.point_count() == 8);
  // Halstead's mask of valence 3: (9 v + 4 edges + faces) / 24; of a cube's corner at (1, 1, 1) / 2 ...
  // neighbours sum to 1/2 (1, 1, 1), opposite corners of the faces to -1/2 (1, 1, 1).
  for (const Vec3f& p : positions(mesh, cage.positions.data())) {
    const double size = std::abs(double(cage.positions[0].x));
    const double expected = size * (9.0 + 4.0 * 1.0 - 1.0) / 24.0;
    for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(p[axis]) == doctest::Approx(expected).epsilon(1e-6));
  }
}

TEST_CASE("an edge is looked at where the limit surface has it, at every pose") {
  const SubdivisionMesh cage = cube_cage();
  std::vector<Vec3f> larger = cage.positions;
  for (Vec3f& p : larger) p = p * 2.0f;
  const Vec3f* poses[] = {cage.positions.data(), larger.data()};
  std::atomic<int> asked = 0;
  const double size = std::abs(double(cage.positions[0].x));
  const auto look = [&](const CageEdge& edge) {
    ++asked;
    REQUIRE(edge.curves.size() == 2);
    for (int i = 0; i < 3; ++i)
      CHECK(length(edge.curves[1][std::size_t(i)] - edge.curves[0][std::size_t(i)] * 2.0) < 1e-6);
    for (const int end : {0, 2}) {
      const Vec3d p = edge.curves[0][std::size_t(end)], v(cage.positions[end == 0 ? edge.a : edge.b]);
      CHECK(length(p - v * 0.5) < 1e-6 * size);
    }
    return 1u;
  };
  const RefinedMesh mesh(cage, poses, look, kPlenty);
  CHECK(asked == 12);
}

TEST_CASE("too many points lower every level alike") {
  const SubdivisionMesh cage = cube_cage();
  const RefinedMesh mesh(cage, {}, everywhere(6), 6 * 16 * 16 + 8);
  CHECK(mesh.lowered() == 2);
  CHECK(mesh.triangles().size() == 2 * 6 * 16 * 16);
  CHECK(RefinedMesh(cage, {}, everywhere(6), 1).triangles().size() == 12);
  CHECK(RefinedMesh(cage, {}, everywhere(3), kPlenty).lowered() == 0);
}

TEST_CASE("normals are those of a sphere-like cage's limit, whichever face sees the point") {
  // Normals against the surface's own differences: the triangles' normals around a point, finely cut.
  const SubdivisionMesh cage = prism_cage(5);
  const RefinedMesh mesh(cage, {}, everywhere(6), kPlenty);
  CHECK_FALSE(mesh.has_creases());
  const std::vector<Vec3f> p = positions(mesh, cage.positions.data()),
                           n = mesh.normals(cage.positions.data());
  REQUIRE(n.size() == mesh.point_count());
  std::vector<Vec3d> sums(mesh.point_count());
  for (const Triangle& t : mesh.triangles()) {
    const Vec3d normal = cross(Vec3d(p[t[1]]) - Vec3d(p[t[0]]), Vec3d(p[t[2]]) - Vec3d(p[t[0]]));
    for (const std::uint32_t v : t) sums[v] += normal;
  }
  double worst = 0.0;
  for (std::uint32_t v = 0; v < n.size(); ++v)
    worst = std::max(worst, length(normalize(sums[v]) - Vec3d(n[v])));
  CHECK(worst < 0.05);
}

TEST_CASE("a crease has a normal for each side") {
  SubdivisionMesh cage = cube_cage();
  cage.scheme = SubdivisionScheme::kBilinear;
  const RefinedMesh mesh(cage, {}, everywhere(2), kPlenty);
  REQUIRE(mesh.has_creases());
  const std::vector<Vec3f> n = mesh.normals(cage.positions.data());
  REQUIRE(n.size() == 3 * mesh.triangles().size());
  const std::vector<Vec3f> p = positions(mesh, cage.positions.data());
  for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle& v = mesh.triangles()[t];
    const Vec3d flat = normalize(cross(Vec3d(p[v[1]]) - Vec3d(p[v[0]]), Vec3d(p[v[2]]) - Vec3d(p[v[0]])));
    for (int i = 0; i < 3; ++i) CHECK(length(Vec3d(n[3 * t + std::size_t(i)]) - flat) < 1e-6);
  }
  SubdivisionMesh semi_sharp = cube_cage();
  semi_sharp.crease_lengths = {2};
  semi_sharp.crease_indices = {0, 1};
  semi_sharp.crease_sharpnesses = {3.0f};
  CHECK_FALSE(RefinedMesh(semi_sharp, {}, everywhere(1), kPlenty).has_creases());
  semi_sharp.crease_sharpnesses = {10.0f};
  CHECK(RefinedMesh(semi_sharp, {}, everywhere(1), kPlenty).has_creases());
}

TEST_CASE(
    "vertex values follow the surface, varying ones are linear on the cage, face-varying ones keep seams") {
  SubdivisionMesh cage = sheet_cage(3, 4);
  // Vertex values that are the positions end where the points are.
  std::vector<float> values;
  for (const Vec3f& p : cage.positions) values.insert(values.end(), {p.x, p.y, p.z});
  const RefinedMesh mesh(cage, {}, everywhere(2), kPlenty);
  const std::vector<Vec3f> p = positions(mesh, cage.positions.data());
  const std::vector<float> vertex = at_points(mesh, values, 3);
  for (std::size_t i = 0; i < p.size(); ++i)
    CHECK(Vec3f{vertex[3 * i], vertex[3 * i + 1], vertex[3 * i + 2]} == p[i]);

  // Varying: of values 0 and 1 the middle of an edge has 0.5, whatever the scheme; vertices keep their own.
  std::vector<float> ramp;
  for (std::uint32_t v = 0; v < cage.vertex_count; ++v) ramp.push_back(float(v % 2));
  const std::vector<float> varying = at_points(mesh, ramp, 1, {ValueKind::kVarying, 0});
  std::set<float> found(varying.begin(), varying.end());
  CHECK(found.contains(0.0f));
  CHECK(found.contains(1.0f));
  CHECK(found.contains(0.5f));
  for (const float v : found) CHECK(std::fmod(v * 16.0f, 1.0f) == 0.0f);

  // A value of its own at every corner: inside each face what its corners say, by its own number.
  FaceVaryingTopology seams;
  seams.value_count = std::uint32_t(cage.face_vertex_indices.size());
  for (std::uint32_t i = 0; i < seams.value_count; ++i) seams.indices.push_back(i);
  FaceVaryingTopology joined;
  joined.value_count = cage.vertex_count;
  joined.indices = cage.face_vertex_indices;
  cage.face_varying = {seams, joined};
  cage.face_varying_rule = FaceVaryingRule::kNone;
  const RefinedMesh both(cage, {}, everywhere(2), kPlenty);
  std::vector<float> of_face;
  for (std::uint32_t i = 0; i < seams.value_count; ++i) of_face.push_back(float(i / 4));
  const std::vector<float> apart = at_corners(both, of_face, 1, {ValueKind::kFaceVarying, 0});
  for (std::size_t c = 0; c < apart.size(); ++c)
    CHECK(apart[c] == doctest::Approx(float(both.faces()[c / 3])).epsilon(1e-5));
  // Joined as the vertices are, and smooth at the boundary as they are: the vertices' own values.
  const std::vector<float> together = at_corners(both, values, 3, {ValueKind::kFaceVarying, 1});
  const std::vector<float> expected = at_corners(both, values, 3, {});
  for (std::size_t c = 0; c < together.size(); ++c)
    CHECK(together[c] == doctest::Approx(expected[c]).epsilon(1e-5));
}

TEST_CASE("holes have no triangles; what OpenSubdiv refuses is an error that names the mesh") {
  SubdivisionMesh cage = cube_cage();
  cage.holes = {2};
  const RefinedMesh mesh(cage, {}, everywhere(1), kPlenty);
  CHECK(mesh.triangles().size() == 5 * 8);
  CHECK(std::ranges::find(mesh.faces(), 2u) == mesh.faces().end());
  SubdivisionMesh bad = cube_cage();
  bad.name = "/cube";
  bad.face_varying = {{3, {0, 1, 2}}};
  CHECK_THROWS_WITH_AS(RefinedMesh(bad, {}, everywhere(1), kPlenty),
                       "/cube: face-varying indices: found 3; expected 24", Error);
}

TEST_CASE("a map's largest stretch is that of the direction it lengthens most") {
  const auto by_search = [](const Affine3d& a) {
    double most = 0.0;
    for (int i = 0; i <= 400; ++i) {
      for (int k = 0; k < 400; ++k) {
        const double z = -1.0 + i / 200.0, turn = k * 2.0 * std::numbers::pi / 400,
                     r = std::sqrt(1.0 - z * z);
        most = std::max(most, length(a.vector(Vec3d{r * std::cos(turn), r * std::sin(turn), z})));
      }
    }
    return most;
  };
  CHECK(largest_stretch({{2, 0, 0}, {0, 3, 0}, {0, 0, 5}, {9, 9, 9}}) == doctest::Approx(5.0));
  CHECK(largest_stretch({{0, 7, 0}, {-7, 0, 0}, {0, 0, 7}, {}}) == doctest::Approx(7.0));
  CHECK(largest_stretch({{}, {}, {}, {}}) == 0.0);
  for (const Affine3d& a : {Affine3d{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}, {}},
                            {{1, 0, 0}, {100, 1, 0}, {0, 0, 1}, {}},
                            {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {}}}) {
    const double found = largest_stretch(a), searched = by_search(a);
    CHECK(found >= searched * (1.0 - 1e-12));
    CHECK(found == doctest::Approx(searched).epsilon(1e-3));
  }
}

TEST_CASE("limit points are the mesh's own, with the normals of its surface, means at creases") {
  for (const SubdivisionMesh& cage : {cube_cage(), prism_cage(5), sheet_cage(3, 4)}) {
    const RefinedMesh mesh(cage, {}, uneven, kPlenty);
    const RefinedMesh::LimitPoints limit = mesh.limit(cage.positions.data());
    const std::vector<Vec3f> expected = positions(mesh, cage.positions.data());
    const std::vector<Vec3f> normals = mesh.normals(cage.positions.data());
    for (std::uint32_t p = 0; p < mesh.point_count(); ++p) {
      CHECK(Vec3f(limit.positions[p]) == expected[p]);
      CHECK(length(limit.normals[p] - Vec3d(normals[p])) < 1e-4);
    }
  }
  SubdivisionMesh box = cube_cage();
  box.scheme = SubdivisionScheme::kBilinear;
  const RefinedMesh mesh(box, {}, everywhere(1), kPlenty);
  const RefinedMesh::LimitPoints limit = mesh.limit(box.positions.data());
  int corners = 0, edges = 0, inside = 0;
  for (std::uint32_t p = 0; p < mesh.point_count(); ++p) {
    // How many faces a point of a cube is on is how many of its coordinates are the largest.
    const Vec3d size = abs(limit.positions[p]);
    const double largest = std::max({size.x, size.y, size.z});
    Vec3d expected;
    for (int axis = 0; axis < 3; ++axis) {
      if (size[axis] > 0.999 * largest) expected[axis] = limit.positions[p][axis] > 0 ? 1.0 : -1.0;
    }
    const double faces = dot(expected, expected);
    (faces == 3.0 ? corners : faces == 2.0 ? edges : inside)++;
    CHECK(length(limit.normals[p] - normalize(expected)) < 1e-6);
  }
  CHECK(corners == 8);
  CHECK(edges == 12);
  CHECK(inside == 6);
}

TEST_CASE("a point that faces see has the mean of what they say, each once") {
  const SubdivisionMesh cage = prism_cage(5);
  for (const EdgeLevel& level : {everywhere(0), everywhere(2), EdgeLevel(uneven)}) {
    const RefinedMesh mesh(cage, {}, level, kPlenty);
    const std::vector<double> means =
        mesh.means([](std::uint32_t face, std::span<const SquareLattice> squares, double* out) {
          for (const SquareLattice& square : squares) out = std::fill_n(out, square.points.size(), face);
        });
    std::vector<std::set<std::uint32_t>> seen(mesh.point_count());
    for (const std::uint32_t face : mesh.drawn_faces()) {
      for (const FacePoint& p : mesh.points_of(face)) seen[p.id].insert(face);
    }
    for (std::uint32_t p = 0; p < mesh.point_count(); ++p) {
      double sum = 0.0;
      for (const std::uint32_t face : seen[p]) sum += face;
      CHECK(means[p] == doctest::Approx(sum / double(seen[p].size())));
    }
  }
}

TEST_CASE("the layout of grids has the grids, and the points, that dicing makes") {
  for (const SubdivisionMesh& cage : {cube_cage(), prism_cage(5), prism_cage(3), sheet_cage(3, 4)}) {
    const GridMesh expected = dice(cage, {.level = 3});
    const RefinedMesh mesh(cage, {}, everywhere(3), kPlenty);
    const GridLayout layout = mesh.grid_layout();
    const std::vector<Vec3f> at = positions(mesh, cage.positions.data());
    REQUIRE(layout.grids.size() == expected.grids.size());
    std::size_t next = 0;
    for (std::size_t g = 0; g < layout.grids.size(); ++g) {
      const Grid &found = layout.grids[g], &grid = expected.grids[g];
      CHECK(found.face == grid.face);
      CHECK(found.square == grid.square);
      CHECK(found.rows == grid.rows);
      CHECK(found.columns == grid.columns);
      CHECK(found.first_quad == grid.first_quad);
      CHECK(found.first_value == grid.first_value);
      for (std::uint32_t r = 0; r <= grid.rows; ++r) {
        for (std::uint32_t c = 0; c <= grid.columns; ++c)
          CHECK(at[layout.points[next++]] == expected.control_point(grid, r, c, 0));
      }
    }
    CHECK(next == layout.points.size());
  }
}
