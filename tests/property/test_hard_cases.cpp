// Degenerate input builds in bounded time and memory and traces right; builds are deterministic and can be
// cancelled.
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::accel_of;
using msbvh::property::check_against_oracle;

namespace {

TriangleMesh copies(int count, const Triangle& pattern, std::vector<Vec3f> positions) {
  TriangleMesh mesh;
  mesh.name = "copies";
  mesh.vertex_count = static_cast<std::uint32_t>(positions.size());
  mesh.positions = std::move(positions);
  mesh.triangles.assign(static_cast<std::size_t>(count), pattern);
  return mesh;
}

// The most references that a tree over so many triangles may hold.
std::uint64_t budgeted(std::uint64_t triangles) {
  return triangles +
         static_cast<std::uint64_t>(BuildSettings{}.spatial_split_budget * static_cast<float>(triangles));
}

Ray down(float x, float z) {
  Ray ray;
  ray.org = {x, 2.0f, z};
  ray.dir = {0.0f, -1.0f, 0.0f};
  return ray;
}

}  // namespace

TEST_CASE("no triangle, one triangle") {
  Hit hit;
  const Accel none = accel_of({});
  CHECK_FALSE(none.intersect(down(0, 0), hit));
  CHECK_FALSE(none.occluded(down(0, 0)));
  CHECK_NOTHROW(none.verify());
  const Accel one = accel_of({copies(1, {0, 1, 2}, {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}})});
  CHECK_NOTHROW(one.verify());
  REQUIRE(one.intersect(down(0, 0), hit));
  CHECK(hit.t == 2.0f);
  CHECK(hit.u == doctest::Approx(0.25f));
  CHECK(hit.v == doctest::Approx(0.5f));
}

TEST_CASE("a million triangles in one place") {
  for (const Builder builder : {Builder::kMsbvh, Builder::kMbvh}) {
    const Accel accel =
        accel_of({copies(1'000'000, {0, 1, 2}, {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}})}, builder);
    const BvhStatistics& s = accel.statistics();
    CHECK(s.references <= budgeted(1'000'000));
    CHECK(s.node_bytes + s.leaf_bytes < 200'000'000);
    Hit hit;
    REQUIRE(accel.intersect(down(0, 0), hit));
    CHECK(hit.t == 2.0f);
  }
}

TEST_CASE("triangles without area are built in and never hit") {
  TriangleMesh mesh = soup(200, 0.5f, 2);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 2)
    mesh.triangles[i][2] = mesh.triangles[i][1];                                              // a line
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 10) mesh.triangles[i] = {5, 5, 5};  // a point
  const Accel accel = accel_of({moved(std::move(mesh), 2, translation({1, 0, 0}))});
  CHECK_NOTHROW(accel.verify());
  check_against_oracle(accel, {}, 3.0f, 300, 8);
}

TEST_CASE("a triangle that collapses at the shutter's centre only") {
  // The topology sees lines and points; the keys see triangles.
  TriangleMesh mesh = moved(soup(300, 0.6f, 12), 2, [](const Vec3d& p, double u) {
    const double s = 2.0 * std::abs(u - 0.5);
    return Vec3d{p.x, p.y * s + 1e-7 * p.x, p.z * s};
  });
  const Accel accel = accel_of({std::move(mesh)});
  CHECK_NOTHROW(accel.verify());
  check_against_oracle(accel, {}, 3.0f, 300, 9);
}

TEST_CASE("all in one plane, very large and very small") {
  for (const double scale : {1e-6, 1.0, 1e9}) {
    CAPTURE(scale);
    const Motion scaled = [=](const Vec3d& p, double u) { return (p + Vec3d{0.0, 0.2 * u, 0.0}) * scale; };
    const Accel accel = accel_of({moved(grid(12), 1, scaled)});
    CHECK_NOTHROW(accel.verify());
    check_against_oracle(accel, {}, float(3.0 * scale), 100, 10);
  }
}

TEST_CASE("bad geometry is refused with the mesh's name") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Accel accel;
  CHECK_THROWS_WITH_AS(accel.add_mesh(copies(1, {0, 1, 2}, {{0, 0, 0}, {1, nan, 0}, {0, 0, 1}})),
                       doctest::Contains("vertex 1"), Error);
  CHECK_THROWS_WITH_AS(accel.add_mesh(copies(1, {0, 1, 3}, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}})),
                       doctest::Contains("copies: triangles"), Error);
  TriangleMesh odd = copies(1, {0, 1, 2}, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}});
  odd.segments = 3;
  CHECK_THROWS_AS(accel.add_mesh(odd), Error);
  CHECK_THROWS_AS(accel.bvh(), Error);
  accel.commit();
  CHECK_THROWS_AS(accel.add_mesh(soup(3, 1.0f, 1)), Error);
}

TEST_CASE("the tree is the same, byte for byte, on one thread and on two") {
  const auto build = [](unsigned threads) {
    Accel accel;
    Arena(threads).execute([&] { accel = accel_of({moved(sticks(6000, 3), 2, rotation({0, 1, 0}, 1.0))}); });
    return accel;
  };
  const Accel a = build(1), b = build(2);
  REQUIRE(a.bvh().arena.size() == b.bvh().arena.size());
  CHECK(std::memcmp(a.bvh().arena.data(), b.bvh().arena.data(), a.bvh().arena.size()) == 0);
}

TEST_CASE("a cancelled build throws and leaves the accel open") {
  Accel accel;
  accel.add_mesh(soup(20'000, 0.1f, 1));
  BuildSettings settings;
  settings.cancelled = [] { return true; };
  CHECK_THROWS_AS(accel.commit(settings), Cancelled);
  CHECK_NOTHROW(accel.commit());
  CHECK_NOTHROW(accel.verify());
}

TEST_CASE("the reference budget holds, and spatial splits pay on long thin triangles") {
  TriangleMesh mesh = moved(sticks(4000, 7), 2, rotation({0, 1, 0}, 0.3));
  const Accel with = accel_of({mesh}), without = accel_of({mesh}, Builder::kMbvh);
  CHECK(with.statistics().references <= budgeted(with.statistics().triangles));
  CHECK(without.statistics().references == without.statistics().triangles);
  const auto count = [](const Accel& accel) {
    TraceCounts counts;
    Random random(2);
    for (int i = 0; i < 5000; ++i) {
      Hit hit;
      Tracer(accel.bvh()).intersect_counted(random_ray(random, {}, 3.0f), hit, counts);
    }
    return counts;
  };
  const TraceCounts a = count(with), b = count(without);
  MESSAGE("nodes a ray ", double(a.nodes) / double(a.rays), " against ", double(b.nodes) / double(b.rays),
          ", triangles ", double(a.primitives) / double(a.rays), " against ",
          double(b.primitives) / double(b.rays));
  CHECK((a.nodes < b.nodes || a.primitives < b.primitives));
}
