// Refined cages that are taken again: what they give is what new ones give, bit by bit, in bounded memory.
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/subdivision/refinement_cache.h"
#include "tests/support/cages.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

constexpr std::uint64_t kPlenty = 1 << 24;

EdgeLevel everywhere(std::uint32_t level) {
  return [level](const CageEdge&) { return level; };
}
// By the length of the limit's edge: what it is depends on the pose.
EdgeLevel by_length(double unit) {
  return [unit](const CageEdge& edge) {
    double longest = 0.0;
    for (const auto& [start, middle, end] : edge.curves)
      longest = std::max(longest, length(middle - start) + length(end - middle));
    const double level = std::log2(longest / unit);
    return level > 0.0 ? static_cast<std::uint32_t>(level) : 0;
  };
}

std::vector<Vec3f> positions(const RefinedMesh& mesh, const Vec3f* cage) {
  std::vector<Vec3f> out(mesh.point_count());
  const float* from[] = {&cage->x};
  float* to[] = {&out[0].x};
  mesh.at_points({}, 3, from, to);
  return out;
}

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool same_bits(const RefinedMesh& a, const RefinedMesh& b, const Vec3f* pose) {
  return same_bits(a.triangles(), b.triangles()) && same_bits(a.faces(), b.faces()) &&
         a.lowered() == b.lowered() && a.has_creases() == b.has_creases() &&
         same_bits(positions(a, pose), positions(b, pose)) && same_bits(a.normals(pose), b.normals(pose));
}

Cage creased(Cage cage, float sharpness) {
  cage.crease_lengths = {5};
  cage.crease_indices = {0, 1, 3, 2, 0};
  cage.crease_sharpnesses = {sharpness};
  return cage;
}

}  // namespace

TEST_CASE("what is taken again is what a new one is, whatever came before") {
  RefinementCache cache;
  const auto turn = [](const Vec3d& p, double u) {
    return Vec3d{p.x * std::cos(u) - p.y * std::sin(u), p.x * std::sin(u) + p.y * std::cos(u), p.z * (1 + u)};
  };
  for (const SubdivisionMesh& still : {prism_cage(5), sheet_cage(3, 4), octahedron_cage(), prism_cage(5)}) {
    const SubdivisionMesh mesh = moved(still, {8, 1}, turn);
    for (std::uint32_t key : {0u, 8u, 4u, 0u, 1u}) {
      for (const double unit : {0.1, 0.3, 0.1}) {
        const Vec3f* pose = mesh.control_positions(key);
        const std::vector<const Vec3f*> poses{pose};
        const auto kept = cache.mesh(mesh, poses, by_length(unit), kPlenty);
        CHECK(same_bits(*kept, RefinedMesh(mesh, poses, by_length(unit), kPlenty), pose));
      }
    }
  }
  CHECK(cache.counts().cages_made == 3);
  CHECK(cache.counts().cages_kept == 4 * 15 - 3);
  CHECK(cache.counts().meshes_made + cache.counts().meshes_kept == 4 * 15);
  CHECK(cache.counts().meshes_made > 6);
  CHECK(cache.counts().meshes_kept >= 20);
}

TEST_CASE("a cage is taken again under another name, and not with another sharpness, hole or rule") {
  RefinementCache cache;
  const auto made = [&](const Cage& cage) {
    const std::size_t before = cache.counts().cages_made;
    cache.mesh(cage, {}, everywhere(2), kPlenty);
    return cache.counts().cages_made > before;
  };
  Cage cage = creased(cube_cage(), 1.5f);
  CHECK(made(cage));
  CHECK_FALSE(made(cage));
  cage.name = "/Another";
  CHECK_FALSE(made(cage));
  CHECK(made(creased(cube_cage(), 1.25f)));
  cage.holes = {1};
  CHECK(made(cage));
  cage.holes = {2};
  CHECK(made(cage));
  cage.boundary = BoundaryRule::kEdgeOnly;
  CHECK(made(cage));
  cage.left_handed = true;
  CHECK(made(cage));
  cage.face_varying = {{1, std::vector<std::uint32_t>(24, 0)}};
  CHECK(made(cage));
  cage.face_varying_rule = FaceVaryingRule::kAll;
  CHECK(made(cage));
  cage.scheme = SubdivisionScheme::kBilinear;
  CHECK(made(cage));
  CHECK_FALSE(made(cage));
}

TEST_CASE("memory is bounded: what was used longest ago goes first") {
  const Cage a = cube_cage(), b = prism_cage(5), c = prism_cage(7);
  RefinementCache plenty;
  for (const Cage& cage : {a, b, c}) plenty.mesh(cage, {}, everywhere(5), kPlenty);
  const std::size_t three = plenty.bytes();
  // Triangles and the faces that they are of are most of it.
  CHECK(three > 16 * (6 + 7 + 9) * 2 * 32 * 32 / 2);

  RefinementCache cache(three - 1);
  for (const Cage& cage : {a, b, a, c}) {
    cache.mesh(cage, {}, everywhere(5), kPlenty);
    CHECK(cache.bytes() < three);
  }
  CHECK(cache.counts().meshes_made == 3);
  cache.mesh(a, {}, everywhere(5), kPlenty);
  CHECK(cache.counts().meshes_kept == 2);
  cache.mesh(b, {}, everywhere(5), kPlenty);
  CHECK(cache.counts().meshes_made == 4);
}

TEST_CASE("what does not fit at all is made and not kept") {
  RefinementCache none(0);
  const SubdivisionMesh cage = prism_cage(5);
  for (int i = 0; i < 2; ++i) {
    const auto mesh = none.mesh(cage, {}, everywhere(3), kPlenty);
    CHECK(same_bits(*mesh, RefinedMesh(cage, {}, everywhere(3), kPlenty), cage.positions.data()));
    CHECK(none.bytes() == 0);
  }
  CHECK(none.counts().cages_made == 2);
}

TEST_CASE("a cage that is refused is refused again, by its own name") {
  RefinementCache cache;
  Cage bad = cube_cage();
  bad.face_vertex_indices[0] = 8;
  for (const char* name : {"/One", "/Two"}) {
    bad.name = name;
    const std::string start = std::string(name) + ": faceVertexIndices";
    try {
      cache.mesh(bad, {}, everywhere(1), kPlenty);
      FAIL("taken");
    } catch (const Error& error) {
      CHECK(std::string(error.what()).starts_with(start));
    }
  }
  CHECK(cache.bytes() == 0);
}
