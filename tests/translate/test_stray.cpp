// How far what is drawn strays from the true surface: measured against brute force over limit points by
// Catmull-Clark's rules written out (tests/support/catmull_clark.h), which share nothing with OpenSubdiv.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <doctest/doctest.h>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/triangle_distance.h"
#include "core/scene/scene.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/shape/sides.h"
#include "delegate/translate/shape/surface.h"
#include "delegate/translate/stray/stray.h"
#include "delegate/translate/translator.h"
#include "tests/support/cages.h"
#include "tests/support/catmull_clark.h"
#include "tests/translate/translate_inputs.h"
#include "tests/translate/translate_shapes.h"

using namespace msbvh;
using namespace msbvh::procedural;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

const Vec3d kEye{0, 0, 10};

TranslatorSettings measuring(double edge_pixels, std::uint32_t width = 1000) {
  TranslatorSettings settings = settings_of(width);
  settings.edge_length_pixels = edge_pixels;
  settings.measure_shape = true;
  return settings;
}

MeshFixture fixture_of(const SubdivisionMesh& cage) {
  MeshFixture fixture;
  fixture.counts.assign(cage.face_vertex_counts.begin(), cage.face_vertex_counts.end());
  fixture.indices.assign(cage.face_vertex_indices.begin(), cage.face_vertex_indices.end());
  fixture.points = {cage.positions};
  return fixture;
}

// What a translator makes of one mesh.
struct Drawn {
  std::optional<double> stray;
  std::vector<TriangleCorners> triangles;  // at the first control, in stage space
};

Drawn drawn(const MeshInput& input, const TranslatorSettings& settings) {
  Translator translator(camera_at(kEye), settings);
  translator.add_mesh(input);
  Drawn result{translator.tracks().back().shape_error_pixels, {}};
  const Vec3d origin = translator.origin();
  const auto scene = translator.finish();
  const TriangleMesh& mesh = scene->meshes.front().shape;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](std::uint32_t i) { return Vec3d(mesh.positions[i]) + origin; };
    result.triangles.push_back({at(t[0]), at(t[1]), at(t[2])});
  }
  return result;
}

Drawn drawn(const SubdivisionMesh& cage, const TranslatorSettings& settings,
            const char* scheme = "catmullClark") {
  const MeshFixture fixture = fixture_of(cage);
  MeshInput input = fixture.input();
  input.subdivision.scheme = scheme;
  return drawn(input, settings);
}

std::vector<Vec3d> limit_points(const SubdivisionMesh& cage, int level) {
  CatmullClark truth(cage);
  for (int i = 0; i < level; ++i) truth.refine();
  std::vector<Vec3d> result;
  for (const auto& [place, point] : truth.limits(level)) result.push_back(point);
  return result;
}

double pixels_of(double distance, const Vec3d& place) {
  const ScreenMeasure measure(camera_at(kEye), {}, 1000, 1000);
  return measure.at(0.5).at_point(distance, place);
}

// From each limit point to the nearest of all triangles.
double brute_force(const std::vector<Vec3d>& limit, const std::vector<TriangleCorners>& triangles) {
  double worst = 0.0;
  for (const Vec3d& p : limit) {
    double least = std::numeric_limits<double>::infinity();
    for (const TriangleCorners& t : triangles) {
      const double reach = std::max(length(t[1] - t[0]), length(t[2] - t[0]));
      if (length(p - t[0]) - reach < least) least = std::min(least, distance_to_triangle(p, t));
    }
    worst = std::max(worst, pixels_of(least, p));
  }
  return worst;
}

// Flat, with a straight rim.
MeshFixture uneven_sheet() {
  MeshFixture sheet;
  sheet.counts.clear();
  sheet.indices.clear();
  sheet.points.front().clear();
  for (int r = 0; r <= 4; ++r) {
    for (int c = 0; c <= 4; ++c) {
      const bool inside = r > 0 && r < 4 && c > 0 && c < 4;
      const float shift = inside ? 0.13f * float((r * 5 + c * 3) % 4) : 0.0f;
      sheet.points.front().push_back({float(c) + shift, float(r) - shift, 0.0f});
      if (r == 4 || c == 4) continue;
      sheet.counts.push_back(4);
      for (const int i : {0, 1, 6, 5}) sheet.indices.push_back(r * 5 + c + i);
    }
  }
  return sheet;
}

}  // namespace

TEST_SUITE("translate: stray") {
  TEST_CASE("refined triangles stray by what dense limit points do from them") {
    for (const SubdivisionMesh& cage : {cube_cage(), prism_cage(3), prism_cage(5), sheet_cage(3, 4)}) {
      const std::vector<Vec3d> limit = limit_points(cage, 6);
      for (const double edge : {160.0, 80.0, 40.0, 20.0}) {
        const Drawn found = drawn(cage, measuring(edge));
        REQUIRE(found.stray.has_value());
        CAPTURE(found.triangles.size());
        const double share = *found.stray / brute_force(limit, found.triangles);
        CHECK(share >=
              (edge > 20.0 ? 0.88 : 0.97));  // few places say less of a warped face than of a flat one
        CHECK(share <= 1.03);
      }
    }
  }

  TEST_CASE("half the edges' length quarters it: 0.2 to 0.33 of it while edges are halved everywhere") {
    for (const SubdivisionMesh& cage : {cube_cage(), prism_cage(5)}) {
      double last = *drawn(cage, measuring(40.0)).stray;
      for (const double edge : {20.0, 10.0, 5.0, 2.5}) {
        const double here = *drawn(cage, measuring(edge)).stray;
        CHECK(here / last >= 0.2);
        CHECK(here / last <= 0.33);
        last = here;
      }
    }
  }

  TEST_CASE("a cage drawn as polygons: the surface to them, and their vertices to the surface") {
    for (const SubdivisionMesh& cage : {cube_cage(), prism_cage(3), prism_cage(5)}) {
      const std::vector<Vec3d> limit = limit_points(cage, 6);
      const Drawn found = drawn(cage, measuring(0.0));
      REQUIRE(found.stray.has_value());
      double worst = brute_force(limit, found.triangles);
      for (const Vec3f& vertex : cage.positions) {
        double least = std::numeric_limits<double>::infinity();
        for (const Vec3d& p : limit) least = std::min(least, length(Vec3d(vertex) - p));
        worst = std::max(worst, pixels_of(least, Vec3d(vertex)));
      }
      CHECK(*found.stray == doctest::Approx(worst).epsilon(0.04));
      CHECK(*found.stray > *drawn(cage, measuring(160.0)).stray);
    }
  }

  TEST_CASE("parameters that are spread unevenly over a plane are not seen") {
    const MeshFixture sheet = uneven_sheet();
    MeshInput input = sheet.input();
    input.subdivision.scheme = "catmullClark";
    for (const double edge : {0.0, 100.0, 10.0}) CHECK(*drawn(input, measuring(edge)).stray < 1e-3);
  }

  TEST_CASE("triangles without area have a distance, too") {
    const Vec3d a{0, 0, 0}, b{2, 0, 0}, p{1, 1, 0};
    for (const TriangleCorners& flat : {TriangleCorners{a, a, b}, TriangleCorners{a, b, b},
                                        TriangleCorners{b, a, b}, TriangleCorners{a, b, a}})
      CHECK(distance_to_triangle(p, flat) == doctest::Approx(1.0));
    CHECK(distance_to_triangle(p, {a, a, a}) == doctest::Approx(std::sqrt(2.0)));
  }

  TEST_CASE("a hole's rim is seen, also in a plane") {
    MeshFixture sheet = uneven_sheet();
    sheet.holes = {5};  // inside
    MeshInput input = sheet.input();
    input.subdivision.scheme = "catmullClark";
    CHECK(*drawn(input, measuring(40.0)).stray > 0.1);
  }

  TEST_CASE("bilinear faces stray where they are twisted, and Loop's surfaces as others") {
    MeshFixture twisted;  // its centre lies half a unit above one diagonal and below the other
    twisted.points = {{{-1, -1, -0.5f}, {1, -1, 0.5f}, {1, 1, -0.5f}, {-1, 1, 0.5f}}};
    MeshInput input = twisted.input();
    input.subdivision.scheme = "bilinear";
    const double found = *drawn(input, measuring(0.0)).stray;
    // The centre to the planes of both triangles: half a unit along z, over the square root of 1.5.
    CHECK(found == doctest::Approx(pixels_of(0.5 / std::sqrt(1.5), {0, 0, 0})).epsilon(0.02));
    CHECK(*drawn(octahedron_cage(), measuring(10.0), "loop").stray > 0.0);
    CHECK(*drawn(octahedron_cage(), measuring(10.0), "loop").stray < 1.0);
  }

  TEST_CASE("it is measured where it is asked for alone; polygons have none") {
    const MeshFixture square;
    CHECK(*drawn(square.input(), measuring(1.0)).stray == 0.0);
    CHECK_FALSE(drawn(square.input(), settings_of()).stray.has_value());
    CHECK_FALSE(drawn(cube_cage(), settings_of()).stray.has_value());
    MeshInput unknown = square.input();
    unknown.subdivision.scheme = "butterfly";
    CHECK_FALSE(drawn(unknown, measuring(1.0)).stray.has_value());
    MeshInput approximate = square.input();
    approximate.stray = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(drawn(approximate, measuring(1.0)).stray.has_value());
  }

  TEST_CASE("what deforms is looked at at both ends, what is out of the picture not at all") {
    SubdivisionMesh flat = sheet_cage(3, 4);
    MeshFixture fixture = fixture_of(flat);
    for (Vec3f& p : flat.positions) p.z = 0.0f;
    fixture.points = {flat.positions, fixture.points.front()};
    fixture.times01 = {0.0, 1.0};
    MeshInput input = fixture.input();
    input.subdivision.scheme = "catmullClark";
    const double moving = *drawn(input, measuring(40.0)).stray;
    const double rough = *drawn(sheet_cage(3, 4), measuring(40.0)).stray;
    CHECK(moving == doctest::Approx(rough).epsilon(0.02));
    input.world_from_object = still(testing::translation({40, 0, 0}));
    CHECK(*drawn(input, measuring(40.0)).stray == 0.0);
    CHECK(*drawn(input, measuring(0.0)).stray == 0.0);
  }

  TEST_CASE("a prototype strays as where it is seen largest") {
    const MeshFixture fixture = fixture_of(cube_cage());
    MeshInput input = fixture.input();
    input.subdivision.scheme = "catmullClark";
    Translator translator(camera_at(kEye), measuring(20.0));
    const double pixels_per_unit = 120.0;
    translator.add_prototype_mesh(translator.begin_prototype("/P", pixels_per_unit), input);
    const double found = *translator.tracks().back().shape_error_pixels;
    const auto scene = translator.finish();
    const TriangleMesh& mesh = scene->meshes.front().shape;
    double worst = 0.0;
    for (const Vec3d& p : limit_points(cube_cage(), 6)) {
      double least = std::numeric_limits<double>::infinity();
      for (const Triangle& t : mesh.triangles) {
        const TriangleCorners corners{Vec3d(mesh.positions[t[0]]), Vec3d(mesh.positions[t[1]]),
                                      Vec3d(mesh.positions[t[2]])};
        least = std::min(least, distance_to_triangle(p, corners));
      }
      worst = std::max(worst, least * pixels_per_unit);
    }
    CHECK(found == doctest::Approx(worst).epsilon(0.04));
  }
}

namespace {

// The farthest that dense places of the faces lie inside of a shape of radius 1: `depth(point)`.
template <typename Depth>
double deepest(const Surface& surface, const Depth& depth) {
  constexpr int kSteps = 24;
  double worst = 0.0;
  for (std::size_t face = 0; face < surface.counts.size(); ++face) {
    Vec3d p[4];
    for (int i = 0; i < 4; ++i)
      p[i] = surface.points[std::size_t(surface.indices[4 * face + std::size_t(i)])];
    for (int r = 0; r <= kSteps; ++r) {
      for (int c = 0; c <= kSteps; ++c) {
        const double s = double(c) / kSteps, t = double(r) / kSteps;
        const Vec3d lower = p[0] * (1 - s) + p[1] * s, upper = p[3] * (1 - s) + p[2] * s;
        worst = std::max(worst, depth(lower * (1 - t) + upper * t));
      }
    }
  }
  return worst;
}

}  // namespace

TEST_SUITE("translate: stray of implicit shapes") {
  TEST_CASE("closed forms are what dense places of the faces have") {
    for (const int sides : {8, 12, 24, 96}) {
      const auto off_sphere = [](const Vec3d& p) { return 1.0 - length(p); };
      const double sphere =
          deepest(implicit_surface(ImplicitKind::kSphere, Values{1.0}, Axis::kZ, sides), off_sphere);
      CHECK(stray_of(ImplicitKind::kSphere, sides) >= sphere - 1e-12);
      CHECK(stray_of(ImplicitKind::kSphere, sides) == doctest::Approx(sphere).epsilon(0.002));
      const auto off_capsule = [](const Vec3d& p) {
        const double z = std::max(std::abs(p.z) - 2.0, 0.0);
        return 1.0 - std::sqrt(p.x * p.x + p.y * p.y + z * z);
      };
      const double capsule =
          deepest(implicit_surface(ImplicitKind::kCapsule, Values{1.0, 4.0}, Axis::kZ, sides), off_capsule);
      CHECK(stray_of(ImplicitKind::kCapsule, sides) == doctest::Approx(capsule).epsilon(0.002));
      const auto off_cylinder = [](const Vec3d& p) {
        return std::min(1.0 - std::hypot(p.x, p.y), 1e9 * (1.0 - std::abs(p.z)));  // caps are flat
      };
      const double cylinder =
          deepest(implicit_surface(ImplicitKind::kCylinder, Values{1.0, 2.0}, Axis::kZ, sides), off_cylinder);
      CHECK(stray_of(ImplicitKind::kCylinder, sides) == doctest::Approx(cylinder).epsilon(1e-6));
    }
    for (const ImplicitKind flat : {ImplicitKind::kCube, ImplicitKind::kPlane})
      CHECK(stray_of(flat, 8) == 0.0);
  }

  TEST_CASE("a sphere's is seen at its nearest point, under its transform") {
    const Surface sphere = implicit_surface(ImplicitKind::kSphere, Values{1.0}, Axis::kZ, 24);
    MeshFixture fixture;
    fixture.counts = sphere.counts;
    fixture.indices = sphere.indices;
    fixture.points = {{sphere.points.begin(), sphere.points.end()}};
    fixture.transform = still(scaled(2.0, 2.0, 2.0));
    MeshInput input = fixture.input();
    input.stray = stray_of(ImplicitKind::kSphere, 24);
    CHECK(*drawn(input, measuring(1.0)).stray ==
          doctest::Approx(pixels_of(2.0 * input.stray, {0, 0, 2})).epsilon(1e-6));
  }

  TEST_CASE("where the size of a prototype is not known its instances say it") {
    const Surface sphere = implicit_surface(ImplicitKind::kSphere, Values{1.0}, Axis::kZ, 24);
    MeshFixture fixture;
    fixture.counts = sphere.counts;
    fixture.indices = sphere.indices;
    fixture.points = {{sphere.points.begin(), sphere.points.end()}};
    MeshInput input = fixture.input();
    input.stray = stray_of(ImplicitKind::kSphere, 24);
    Translator translator(camera_at(kEye), measuring(1.0));
    const std::uint32_t prototype = translator.begin_prototype("/S");
    translator.add_prototype_mesh(prototype, input);
    CHECK_FALSE(translator.tracks().back().shape_error_pixels.has_value());
    const std::vector<Matrix4d> matrices{matrix_of(scaled(1, 1, 1, {3, 0, -5})), matrix_of(scaled(2, 2, 2))};
    translator.add_instances(instances_of("/instances", prototype, {0.0}, matrices));
    // The larger one, whose box is 8 units away.
    CHECK(*translator.tracks().back().shape_error_pixels ==
          doctest::Approx(pixels_of(2.0 * input.stray, {0, 0, 2})).epsilon(1e-6));
  }
}
