// An Accel that is used too early, after a commit that failed, or after a move throws Error; an empty one is
// hit by nothing.
#include <array>
#include <doctest/doctest.h>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/base/error.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"

namespace msbvh {
namespace {

TriangleMesh triangle() {
  TriangleMesh mesh;
  mesh.vertex_count = 3;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

const Ray kRay{.org = {0, 0, 1}, .dir = {0, 0, -1}};

// Every way to ask, each of which must complain in these words.
void check_complaint(const Accel& accel, const char* expected) {
  const std::array<Ray, 2> rays{kRay, kRay};
  std::array<Hit, 2> hits;
  std::array<bool, 2> occluded;
  Hit hit;
  CHECK_THROWS_WITH_AS(accel.intersect(kRay, hit), doctest::Contains(expected), Error);
  CHECK_THROWS_WITH_AS(accel.occluded(kRay), doctest::Contains(expected), Error);
  CHECK_THROWS_WITH_AS(accel.intersect(rays, hits.data()), doctest::Contains(expected), Error);
  CHECK_THROWS_WITH_AS(accel.occluded(rays, occluded.data()), doctest::Contains(expected), Error);
  CHECK_THROWS_WITH_AS(accel.bvh(), doctest::Contains(expected), Error);
  CHECK_THROWS_WITH_AS(accel.statistics(), doctest::Contains(expected), Error);
  CHECK_THROWS_WITH_AS(accel.verify(), doctest::Contains(expected), Error);
  CHECK(!hit.found());
}

TEST_CASE("before commit() every use throws") {
  Accel accel;
  check_complaint(accel, "before commit()");
  accel.add_mesh(triangle());
  check_complaint(accel, "before commit()");
  Accel next;
  CHECK_THROWS_WITH_AS(next.commit_from(accel), doctest::Contains("before commit()"), Error);
  CHECK_THROWS_WITH_AS(next.commit_from(next), doctest::Contains("before commit()"), Error);
  const auto object = std::make_shared<Accel>();
  CHECK_THROWS_WITH_AS(next.add_instances(object, {}, std::array{Affine3f{}}),
                       doctest::Contains("before commit()"), Error);
  CHECK_THROWS_AS(next.add_instances(nullptr, {}, std::array{Affine3f{}}), Error);
  CHECK_THROWS_AS(next.add_mesh(std::shared_ptr<const TriangleMesh>()), Error);
}

TEST_CASE("after a commit that threw every use throws, and a second commit succeeds") {
  Accel accel;
  accel.add_mesh(procedural::grid(100));  // a build asks now and then: a small one never does
  BuildSettings cancelled;
  cancelled.cancelled = [] { return true; };
  CHECK_THROWS_AS(accel.commit(cancelled), Cancelled);
  check_complaint(accel, "before commit()");
  accel.commit();
  CHECK(accel.statistics().triangles == 20000);
  CHECK_NOTHROW(accel.occluded(kRay));
  CHECK_THROWS_AS(accel.commit(), Error);
  CHECK_THROWS_AS(accel.add_mesh(triangle()), Error);
  CHECK_THROWS_AS(accel.set_time_remap({}), Error);
}

TEST_CASE("what an Accel was moved from throws") {
  Accel accel;
  accel.add_mesh(triangle());
  accel.commit();
  Accel moved = std::move(accel);
  CHECK(moved.occluded(kRay));
  check_complaint(accel, "moved from");
  CHECK_THROWS_AS(accel.add_mesh(triangle()), Error);
  CHECK_THROWS_AS(accel.commit(), Error);
}

TEST_CASE("an Accel without anything in it is hit by nothing") {
  Accel empty;
  empty.commit();
  Accel without_triangles;
  TriangleMesh mesh = triangle();
  mesh.triangles.clear();
  without_triangles.add_mesh(mesh);
  without_triangles.commit();
  for (const Accel* accel : {&empty, &without_triangles}) {
    const std::vector<Ray> rays(100, kRay);
    std::vector<Hit> hits(rays.size(), Hit{.triangle = 7});
    Hit hit;
    CHECK(!accel->intersect(kRay, hit));
    CHECK(!accel->occluded(kRay));
    accel->intersect(rays, hits.data());
    for (const Hit& h : hits) CHECK(!h.found());
    accel->intersect(std::span<const Ray>{}, nullptr);
    CHECK_NOTHROW(accel->verify());
  }
}

TEST_CASE("many threads that ask too early get an Error each") {
  const Accel accel;
  std::array<bool, 4> threw{};
  std::vector<std::thread> threads;
  for (bool& mine : threw) {
    threads.emplace_back([&accel, &mine] {
      try {
        accel.occluded(kRay);
      } catch (const Error&) {
        mine = true;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(threw == std::array{true, true, true, true});
}

}  // namespace
}  // namespace msbvh
