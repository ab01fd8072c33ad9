// What fuzzing has found (docs/design/bad_input.md), each in the fewest words.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <optional>
#include <vector>

#include "core/api/accel.h"
#include "core/base/error.h"
#include "core/bvh/bvh.h"
#include "core/geometry/curve_set.h"
#include "core/geometry/point_set.h"
#include "core/geometry/subdivision/refined_mesh.h"
#include "core/integrate/mis.h"
#include "core/shade/light/light.h"
#include "core/trace/oracle.h"
#include "core/trace/tracer.h"
#include "delegate/translate/normals.h"

using namespace msbvh;

namespace {

TriangleMesh triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  TriangleMesh mesh;
  mesh.name = "/triangle";
  mesh.vertex_count = 3;
  mesh.positions = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

Accel accel_of(TriangleMesh mesh) {
  Accel accel;
  accel.add_mesh(std::move(mesh));
  accel.commit();
  return accel;
}

}  // namespace

TEST_CASE("a triangle as large as coordinates may be is hit where it is, along a ray of any length") {
  constexpr float kFar = 0x1p58f;
  const Accel accel = accel_of(triangle({-kFar, -kFar, 0}, {kFar, -kFar, 0}, {0, kFar, 0}));
  for (const InstructionSet set : supported_instruction_sets()) {
    for (const float length : {1.0f, 1e-3f, 1e6f, kFar}) {
      CAPTURE(instruction_set_name(set));
      CAPTURE(length);
      const Ray ray{.org = {0, 0, kFar}, .dir = {0, 0, -length}};
      Hit hit;
      REQUIRE(Tracer(accel.bvh(), set).intersect(ray, hit));
      CHECK(hit.t == doctest::Approx(double(kFar) / length).epsilon(1e-6));
    }
  }
}

TEST_CASE("the oracle leaves open what double precision cannot tell: a small triangle far away") {
  const Accel accel = accel_of(triangle({480, -187, -272}, {799, -328, 390}, {574, -205, -129}));
  for (int i = 0; i < 200; ++i) {
    const float aside = float(i) * 0.01f;
    const Ray ray{.org = {-3.6e17f, 1.2e17f, -5.1e17f}, .dir = {9.4e17f, -1.3e17f + aside * 1e16f, 3.9e17f}};
    Hit hit;
    const bool found = accel.intersect(ray, hit);
    const auto wrong = judge_intersection(accel.bvh(), ray, found ? std::optional(hit) : std::nullopt);
    CHECK_MESSAGE(!wrong, wrong.value_or(""));
  }
}

TEST_CASE("the oracle knows what underflows in single precision") {
  const float s = 1e-19f;
  const Accel accel = accel_of(triangle({-s, -s, 0}, {s, -s, 0}, {0, s, 0}));
  for (const float length : {1.0f, 1e18f}) {
    const Ray ray{.org = {0, 0, s}, .dir = {0, 0, -length}};
    Hit hit;
    const bool found = accel.intersect(ray, hit);
    CHECK(!judge_intersection(accel.bvh(), ray, found ? std::optional(hit) : std::nullopt));
  }
}

TEST_CASE("moving points without radii, and no points, make an empty tree in time slices too") {
  for (const Builder builder : {Builder::kMsbvh, Builder::kTimeSplit}) {
    for (const std::uint32_t count : {0u, 3u}) {
      PointSet points;
      points.name = "/points";
      points.segments = 4;
      points.point_count = count;
      points.vertices.resize(5 * count);
      Accel accel;
      accel.add_points(points);
      BuildSettings settings;
      settings.builder = builder;
      settings.time_slices = 4;
      accel.commit(settings);
      CHECK_NOTHROW(accel.verify());
      Hit hit;
      CHECK_FALSE(accel.intersect({.org = {0, 0, 1}, .dir = {0, 0, -1}, .time = 0.3f}, hit));
      CHECK_FALSE(accel.occluded({.org = {0, 0, 1}, .dir = {0, 0, -1}, .time = 0.3f}));
    }
  }
}

TEST_CASE("a cage without faces is refused by name, before OpenSubdiv writes to standard error") {
  Cage cage;
  cage.name = "/cage";
  CHECK_THROWS_WITH_AS(validate(cage), "/cage: faceVertexCounts: found no faces; expected some", Error);
}

TEST_CASE(
    "a face that visits a vertex twice is refused by name, before OpenSubdiv writes beyond its memory") {
  Cage cage;
  cage.name = "/cage";
  cage.vertex_count = 5;
  cage.face_vertex_counts = {4, 4};
  cage.face_vertex_indices = {0, 1, 2, 3, 4, 1, 4, 0};
  CHECK_THROWS_WITH_AS(validate(cage),
                       "/cage: faceVertexIndices: face 1 has vertex 4 twice; expected distinct vertices",
                       Error);
}

TEST_CASE("the oracle takes any distance on a triangle that lies in a line with the ray") {
  const Accel accel = accel_of(triangle({0.577340066f, 1, 0.99999994f}, {0.558736145f, 1, 0.99999994f},
                                        {0.633379281f, 1, 0.99999994f}));
  const Ray ray{.org = {0.586813211f, 1, 0.99999994f},
                .dir = {-0.406468391f, 1.1920929e-07f, 1.78813934e-07f}};
  const Hit hit{.t = 5e-12f, .u = 0.34f, .v = 0.28f, .triangle = 0, .geometry = mesh_id(0)};
  CHECK(!judge_intersection(accel.bvh(), ray, hit));
}

TEST_CASE("the power heuristic is a share for densities of any size") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  CHECK(power_heuristic(1.0f, 1.0f) == 0.5f);
  CHECK(power_heuristic(1e20f, 0.3f) == 1.0f);
  CHECK(power_heuristic(0.3f, 1e20f) == 0.0f);
  CHECK(power_heuristic(1e30f, 1e30f) == 0.5f);
  CHECK(power_heuristic(1e-30f, 1e-30f) == 0.5f);
  CHECK(power_heuristic(kInfinity, 0.3f) == 1.0f);
  CHECK(power_heuristic(0.3f, kInfinity) == 0.0f);
}

TEST_CASE("a rectangle so large and far that its solid angle overflows gives nothing") {
  Light light;
  light.kind = LightKind::kRect;
  light.width = light.height = 1e18f;
  light.world_from_light = {Affine3f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1e18f}}};
  LightSample sample;
  CHECK_FALSE(sample_light(light, {}, {}, 0.0f, {0.5f, 0.5f}, sample));
}

TEST_CASE("smooth normals of a curved track stop where they become too many, with a warning") {
  using namespace msbvh::translate;
  TriangleMesh mesh = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.segments = 1;
  mesh.degree = 2;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 9},
                    {0, 1, 0}, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  const auto segments = [&](std::size_t most, std::size_t& warnings) {
    std::vector<Diagnostic> said;
    PrimLog log(said, "/mesh");
    const Primvar<Vec3f> normals = smooth_normals(mesh, kMaxSegments, log, most);
    warnings = said.size();
    CHECK(normals.values.size() == 3 * key_count(normals.segments));
    return normals.segments;
  };
  std::size_t warnings = 0;
  const std::uint32_t enough = segments(kMostNormals, warnings);
  CHECK(enough > 4);
  CHECK(warnings == 0);
  CHECK(segments(3 * 5, warnings) == 4);
  CHECK(warnings == 1);
}
