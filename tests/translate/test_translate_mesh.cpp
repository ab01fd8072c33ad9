// What becomes of one mesh at one time: triangles, primvars, normals, and bad input.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

#include "core/scene/scene.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Translates one mesh seen by a camera at the stage's origin, which is then the frame's.
struct OneMesh {
  explicit OneMesh(const MeshInput& input) : translator(camera_at({}), settings_of()) {
    translator.add_mesh(input);
    diagnostics = translator.diagnostics();
    empty_meshes = translator.empty_meshes();
    scene = translator.finish();
  }
  const Mesh& mesh() const { return scene->mesh(scene->world.at(0)); }

  Translator translator;
  std::vector<Diagnostic> diagnostics;
  std::size_t empty_meshes = 0;
  std::shared_ptr<const Scene> scene;
};

void check_rejected(const MeshFixture& fixture, const std::string& attribute, const std::string& found) {
  const OneMesh result(fixture.input());
  CHECK(result.scene->meshes.empty());
  REQUIRE(result.diagnostics.size() == 1);
  CHECK(result.diagnostics[0].severity == Severity::kError);
  CHECK(result.diagnostics[0].path == "/mesh");
  CHECK(result.diagnostics[0].attribute == attribute);
  INFO(result.diagnostics[0].message);
  CHECK(result.diagnostics[0].message.find(found) != std::string::npos);
  CHECK(result.diagnostics[0].message.find("expected") != std::string::npos);
  CHECK(result.empty_meshes == 0);
}

// A quad and a triangle that share an edge.
MeshFixture two_faces() {
  MeshFixture fixture;
  fixture.counts = {4, 3};
  fixture.indices = {0, 1, 2, 3, 1, 4, 2};
  fixture.points[0].push_back({2, 0.5f, 0});
  return fixture;
}

}  // namespace

TEST_SUITE("translate: mesh") {
  TEST_CASE("faces become fans from their first vertex, wound counter-clockwise from outside") {
    MeshFixture fixture = two_faces();
    CHECK(OneMesh(fixture.input()).mesh().shape.triangles ==
          std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}});
    fixture.left_handed = true;
    CHECK(OneMesh(fixture.input()).mesh().shape.triangles ==
          std::vector<Triangle>{{0, 2, 1}, {0, 3, 2}, {1, 2, 4}});
  }

  TEST_CASE("holes are left out; hole indices out of range are warned about") {
    MeshFixture fixture = two_faces();
    fixture.holes = {0, 7};
    const OneMesh result(fixture.input());
    CHECK(result.mesh().shape.triangles == std::vector<Triangle>{{1, 4, 2}});
    REQUIRE(result.diagnostics.size() == 1);
    CHECK(result.diagnostics[0].attribute == "holeIndices");
    CHECK(result.diagnostics[0].severity == Severity::kWarning);
  }

  TEST_CASE("faces with fewer than three vertices are left out with one warning") {
    MeshFixture fixture = two_faces();
    fixture.counts = {2, 3, 0, 2};
    const OneMesh result(fixture.input());
    CHECK(result.mesh().shape.triangles == std::vector<Triangle>{{2, 3, 1}});
    REQUIRE(result.diagnostics.size() == 1);
    CHECK(result.diagnostics[0].message.find("3 faces") != std::string::npos);
  }

  TEST_CASE("meshes with nothing to draw are counted, not reported") {
    MeshFixture empty;
    empty.counts = empty.indices = {};
    empty.points[0].clear();
    const OneMesh result(empty.input());
    CHECK(result.diagnostics.empty());
    CHECK(result.empty_meshes == 1);
    CHECK(result.scene->meshes.empty());

    MeshFixture all_holes;
    all_holes.holes = {0};
    CHECK(OneMesh(all_holes.input()).empty_meshes == 1);
  }

  TEST_CASE("bad topology is an error that names attribute, found and expected") {
    MeshFixture fixture;
    SUBCASE("counts that do not add up") {
      fixture.counts = {3};
      check_rejected(fixture, "faceVertexCounts", "add up to 3");
    }
    SUBCASE("a negative count") {
      fixture.counts = {5, -1};
      check_rejected(fixture, "faceVertexCounts", "face 1 has -1");
    }
    SUBCASE("an index too large") {
      fixture.indices[2] = 4;
      check_rejected(fixture, "faceVertexIndices", "index 2 is 4");
    }
    SUBCASE("a negative index") {
      fixture.indices[3] = -2;
      check_rejected(fixture, "faceVertexIndices", "index 3 is -2");
    }
    SUBCASE("no points") {
      fixture.points[0].clear();
      check_rejected(fixture, "points", "no points");
    }
  }

  TEST_CASE("bad points and transforms are errors that name the sample") {
    MeshFixture fixture;
    fixture.add_points(0.5, fixture.points[0]);
    SUBCASE("NaN") {
      fixture.points[1][2].y = kNan;
      check_rejected(fixture, "points", "value 2 at shutter time 0.5");
    }
    SUBCASE("times that do not increase") {
      fixture.times01[1] = 0.0;
      check_rejected(fixture, "points", "sample 1 is at time 0");
    }
    SUBCASE("points too far away") {
      fixture.points[0][0].x = 1e30f;
      check_rejected(fixture, "points", "1.0");
    }
    SUBCASE("a matrix that is not finite") {
      fixture.transform.matrices[0][5] = std::numeric_limits<double>::infinity();
      check_rejected(fixture, "xformOpOrder", "time 0");
    }
    SUBCASE("fewer matrices than times") {
      fixture.transform.times01.push_back(1.0);
      check_rejected(fixture, "xformOpOrder", "found 1 matrices");
    }
  }

  TEST_CASE("a number of points that changes holds what the frame has, with a warning") {
    MeshFixture fixture;
    fixture.frame01 = 0.25;
    fixture.add_points(0.5, {{9, 9, 9}});
    MeshInput input = fixture.input();
    std::string said = "found 1 values at shutter time 0.5";
    SUBCASE("under the same faces") {}
    SUBCASE("with the topology") {
      input.topology_varies = true;
      said = "held the frame's pose";
    }
    const OneMesh result(input);
    REQUIRE(result.diagnostics.size() == 1);
    CHECK(result.diagnostics[0].severity == Severity::kWarning);
    CHECK(result.diagnostics[0].message.find(said) != std::string::npos);
    CHECK(result.mesh().shape.segments == 0);
    CHECK(result.mesh().shape.vertex_count == 4);
  }

  TEST_CASE("primvars of every interpolation land on the elements of the triangles") {
    const MeshFixture fixture = two_faces();
    MeshInput input = fixture.input();
    const auto colors = [&](const char* interpolation, const std::vector<float>& values,
                            const std::vector<int>& indices = {}) {
      std::vector<Vec3f> rgb;
      for (const float v : values) rgb.push_back({v, 0, 0});
      input.display_color = {interpolation, rgb, indices};
      const OneMesh result(input);
      CHECK(result.diagnostics.empty());
      std::vector<float> reds;
      for (const Vec3f& color : result.mesh().display_color.values) reds.push_back(color.x);
      return std::pair(result.mesh().display_color.interpolation, reds);
    };
    using Expected = std::pair<Interpolation, std::vector<float>>;
    CHECK(colors("constant", {7}) == Expected{Interpolation::kConstant, {7}});
    CHECK(colors("uniform", {1, 2}) == Expected{Interpolation::kTriangle, {1, 1, 2}});
    CHECK(colors("vertex", {0, 1, 2, 3, 4}) == Expected{Interpolation::kVertex, {0, 1, 2, 3, 4}});
    CHECK(colors("varying", {0, 1, 2, 3, 4}) == Expected{Interpolation::kVertex, {0, 1, 2, 3, 4}});
    CHECK(colors("faceVarying", {0, 1, 2, 3, 4, 5, 6}) ==
          Expected{Interpolation::kFaceVarying, {0, 1, 2, 0, 2, 3, 4, 5, 6}});
    CHECK(colors("uniform", {8, 9}, {1, 0}) == Expected{Interpolation::kTriangle, {9, 9, 8}});
    CHECK(colors("faceVarying", {5, 6}, {0, 0, 1, 1, 0, 1, 0}) ==
          Expected{Interpolation::kFaceVarying, {5, 5, 6, 5, 6, 6, 5, 6, 5}});
  }

  TEST_CASE("faceVarying primvars follow the corners of left-handed faces") {
    MeshFixture fixture;
    fixture.left_handed = true;
    MeshInput input = fixture.input();
    const std::vector<float> opacity{0.0f, 0.1f, 0.2f, 0.3f};
    input.display_opacity = {"faceVarying", opacity, {}};
    CHECK(OneMesh(input).mesh().display_opacity.values ==
          std::vector<float>{0.0f, 0.2f, 0.1f, 0.0f, 0.3f, 0.2f});
  }

  TEST_CASE("a primvar that does not fit is left out with a warning; the mesh is drawn") {
    MeshFixture fixture;
    MeshInput input = fixture.input();
    std::vector<Vec3f> values(4);
    std::vector<int> indices;
    std::string interpolation = "vertex", found;
    SUBCASE("too few values") {
      values.resize(3);
      found = "found 3 values; expected 4";
    }
    SUBCASE("too many indices") {
      indices = {0, 1, 2, 3, 0};
      found = "found 5 indices; expected 4";
    }
    SUBCASE("an index out of range") {
      indices = {0, 1, 4, 3};
      found = "index 2 is 4; expected less than 4";
    }
    SUBCASE("an unknown interpolation") {
      interpolation = "edge";
      found = "\"edge\"";
    }
    SUBCASE("a value that is not finite") {
      values[1].z = kNan;
      found = "value 1 is not finite";
    }
    input.display_color = {interpolation, values, indices};
    const OneMesh result(input);
    CHECK(result.mesh().shape.triangles.size() == 2);
    CHECK_FALSE(result.mesh().display_color.authored());
    REQUIRE(result.diagnostics.size() == 1);
    CHECK(result.diagnostics[0].severity == Severity::kWarning);
    CHECK(result.diagnostics[0].attribute == "primvars:displayColor");
    INFO(result.diagnostics[0].message);
    CHECK(result.diagnostics[0].message.find(found) != std::string::npos);
    CHECK(result.diagnostics[0].message.find("left out") != std::string::npos);
  }

  TEST_CASE("smooth normals are weighted by area and turn with the orientation") {
    // A roof: its slopes face (-1, 0, 1) and (1, 0, 1); the left one is twice as large.
    MeshFixture fixture;
    fixture.counts = {4, 4};
    fixture.indices = {0, 1, 2, 3, 1, 4, 5, 2};
    fixture.points[0] = {{-2, 0, -2}, {0, 0, 0}, {0, 1, 0}, {-2, 1, -2}, {1, 0, -1}, {1, 1, -1}};
    MeshInput input = fixture.input();
    CHECK_FALSE(OneMesh(input).mesh().normals.authored());
    input.computed_normals = Normals::kSmooth;
    const Primvar<Vec3f> normals = OneMesh(input).mesh().normals;
    REQUIRE(normals.values.size() == 6);
    CHECK(normals.interpolation == Interpolation::kVertex);
    const double h = std::sqrt(0.5);
    CHECK(normals.values[0].x == doctest::Approx(-h));
    CHECK(normals.values[4].x == doctest::Approx(h));
    // Vertex 1: two triangles of the left slope would weigh 2, but the fan gives it one of area sqrt(2)
    // (left) and two of area sqrt(2)/2 each (right).
    CHECK(normals.values[1].x == doctest::Approx(0.0));
    CHECK(normals.values[1].z == doctest::Approx(1.0));
    fixture.left_handed = true;
    input = fixture.input();
    input.computed_normals = Normals::kSmooth;
    CHECK(OneMesh(input).mesh().normals.values[1].z == doctest::Approx(-1.0));
  }

  TEST_CASE("authored normals move by the inverse transpose and come before computed ones") {
    MeshFixture fixture;
    fixture.transform = still({{2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}});
    MeshInput input = fixture.input();
    input.computed_normals = Normals::kSmooth;
    const std::vector<Vec3f> normal{{1, 0, 1}};
    input.normals.samples = {{0.0, normal}};
    input.normals_interpolation = "constant";
    const Primvar<Vec3f> normals = OneMesh(input).mesh().normals;
    CHECK(normals.interpolation == Interpolation::kConstant);
    REQUIRE(normals.values.size() == 1);
    CHECK(normals.values[0].x == doctest::Approx(0.5 / std::sqrt(1.25)));
    CHECK(normals.values[0].z == doctest::Approx(1.0 / std::sqrt(1.25)));
  }

  TEST_CASE("normals that do not fit give way to computed ones") {
    MeshFixture fixture;
    MeshInput input = fixture.input();
    input.computed_normals = Normals::kSmooth;
    const std::vector<Vec3f> three(3, Vec3f{0, 0, -1});
    input.normals.samples = {{0.0, three}};
    const OneMesh result(input);
    REQUIRE(result.mesh().normals.values.size() == 4);
    CHECK(result.mesh().normals.values[0].z == 1.0f);
    REQUIRE(result.diagnostics.size() == 1);
    CHECK(result.diagnostics[0].attribute == "normals");
  }

  TEST_CASE("a projective matrix and a missing material are warned about") {
    MeshFixture fixture;
    fixture.transform.matrices[0][15] = 2.0;
    MeshInput input = fixture.input();
    input.material = 3;
    const OneMesh result(input);
    CHECK(result.mesh().material == kNone);
    CHECK(result.diagnostics.size() == 2);
  }

  TEST_CASE("materials of faces go to their triangles, unless all have the same") {
    MeshFixture fixture = two_faces();
    MeshInput input = fixture.input();
    const auto translated = [&](std::vector<int> materials) {
      input.face_materials = materials;
      Translator translator(camera_at({0, 0, 10}), settings_of());
      translator.add_material({});
      translator.add_material({});
      translator.add_mesh(input);
      return std::pair(translator.finish()->meshes.at(0), translator.diagnostics().size());
    };
    const auto [parts, no_complaint] = translated({-1, 1});
    CHECK(no_complaint == 0);
    REQUIRE(parts.triangle_materials.size() == parts.shape.triangles.size());
    CHECK(parts.triangle_materials.front() == kNone);
    CHECK(parts.triangle_materials.back() == 1);
    const Mesh alike = translated({1, 1}).first;
    CHECK(alike.triangle_materials.empty());
    CHECK(alike.material == 1);
    CHECK(translated({0, 2}).second == 1);
    CHECK(translated({0}).second == 1);
  }

  TEST_CASE("what is translated passes the scene's own gate") {
    MeshFixture fixture = two_faces();
    MeshInput input = fixture.input();
    input.computed_normals = Normals::kSmooth;
    const std::vector<Vec3f> colors{{1, 0, 0}, {0, 1, 0}};
    input.display_color = {"uniform", colors, {}};
    const OneMesh result(input);
    CHECK_NOTHROW(validate(*result.scene));
    CHECK(result.mesh().shape.triangles.size() == 3);
  }
}
