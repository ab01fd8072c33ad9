// Probes of a tree: what they aim at, and that they find what is wrong.
#include <algorithm>
#include <doctest/doctest.h>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/base/error.h"
#include "core/probe/aimed_rays.h"
#include "core/probe/closed_mesh.h"
#include "core/probe/posed_mesh.h"
#include "core/probe/probe.h"

using namespace msbvh;

namespace {

// Turns once. A leak names it.
std::shared_ptr<TriangleMesh> turning_ball() {
  TriangleMesh ball = procedural::moved(procedural::sphere(8), 16, procedural::rotation({0, 1, 0}, 6.28));
  ball.name = "/ball";
  return std::make_shared<TriangleMesh>(validated(std::move(ball)));
}

Accel accel_of(const std::shared_ptr<TriangleMesh>& mesh) {
  Accel accel;
  accel.add_mesh(std::shared_ptr<const TriangleMesh>(mesh));
  accel.commit();
  return accel;
}

std::size_t wrong_of(const ProbeReport& report, const std::string& probe) {
  std::size_t sum = 0;
  for (const ProbeResult& result : report.results) sum += result.probe == probe ? result.wrong : 0;
  return sum;
}

constexpr const char* kInside = "rays from inside closed meshes";

}  // namespace

TEST_CASE("a mesh is closed where every edge is used both ways as often") {
  TriangleMesh ball = procedural::sphere(6);
  CHECK(is_closed(ball));
  ball.triangles.push_back({3, 3, 3});  // no edge
  CHECK(is_closed(ball));
  TriangleMesh apart;  // a vertex of its own for each corner
  for (const Triangle& t : ball.triangles) {
    apart.triangles.push_back({apart.vertex_count, apart.vertex_count + 1, apart.vertex_count + 2});
    for (const std::uint32_t v : t) apart.positions.push_back(ball.positions[v]);
    apart.vertex_count += 3;
  }
  CHECK(is_closed(apart));
  apart.positions[5].x += 0.01f;
  CHECK_FALSE(is_closed(apart));
  CHECK_FALSE(is_closed(procedural::grid(4)));
  ball.triangles.erase(ball.triangles.begin());
  CHECK_FALSE(is_closed(ball));
  std::swap(ball.triangles[0][0], ball.triangles[0][1]);  // faces the other way
  CHECK_FALSE(is_closed(ball));
  CHECK_FALSE(is_closed(TriangleMesh{}));
}

TEST_CASE("points are found inside of a closed mesh, off its surface") {
  const auto ball = turning_ball();
  ProbeRandom random(1);
  for (int i = 0; i < 20; ++i) {
    const auto point = PosedMesh({ball.get()}, {random.uniform(), {}}).point_inside(random);
    REQUIRE(point);
    CHECK(length(*point) < length(ball->positions[0]));
  }
}

TEST_CASE("rays are aimed at what they are to meet") {
  const Accel accel = accel_of(turning_ball());
  for (const Aim aim : kAims) {
    CAPTURE(std::string(aim_name(aim)));
    const std::vector<Ray> rays = aimed_rays(accel.bvh(), aim, 2000, 3);
    REQUIRE(rays.size() == 2000);
    CHECK(rays[7].org == aimed_rays(accel.bvh(), aim, 2000, 3)[7].org);
    const auto hits = std::ranges::count_if(rays, [&](Ray ray) {
      ray.tfar = std::numeric_limits<float>::infinity();
      Hit hit;
      return accel.intersect(ray, hit);
    });
    CHECK(hits > (aim == Aim::kAnywhere ? 400 : 1000));
  }
  Accel empty;
  empty.commit();
  CHECK(aimed_rays(empty.bvh(), Aim::kAnywhere, 10, 1).empty());
}

TEST_CASE("probes find nothing in a sound tree, and a tree of what is no longer there") {
  const auto ball = turning_ball();
  const Accel accel = accel_of(ball);
  const ProbeSettings settings{.rays = 20000, .seed = 5, .oracle_tests = 1e5};
  std::size_t calls = 0;
  const ProbeReport sound = probe(accel.bvh(), settings, [&](double done) {
    ++calls;
    return done <= 1.0;
  });
  CHECK(calls == sound.results.size());
  CHECK(sound.meshes == 1);
  CHECK(sound.closed_meshes == 1);
  for (const ProbeResult& result : sound.results) {
    CAPTURE(result.probe);
    CHECK(result.rays >= 19000);
    CHECK_MESSAGE(result.wrong == 0, result.first);
    CHECK(result.judged == (result.probe == kInside ? 0 : 100'000 / ball->triangles.size()));
  }
  // The oracle and the starts read the mesh as it is now; gathered blocks hold what it was.
  for (Vec3f& p : ball->positions) p.x += 4.0f;
  const ProbeReport stale = probe(accel.bvh(), settings);
  CHECK(wrong_of(stale, "rays at edges") > 0);
  CHECK(wrong_of(stale, kInside) > 0);
  CHECK(stale.results.back().first.find("it gets out of /ball") != std::string::npos);
  CHECK_THROWS_AS(probe(accel.bvh(), settings, [](double) { return false; }), Cancelled);
}
