#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/cages.h"
#include "tests/unit/valid_scene.h"

namespace msbvh {
namespace {

TEST_CASE("a valid scene passes") { CHECK(complaint(valid_scene()) == ""); }

TEST_CASE("primvars: each interpolation has its count, times the keys") {
  Scene scene = valid_scene();
  Primvar<Vec3f>& color = scene.meshes[0].display_color;
  const auto accepts = [&](Interpolation interpolation, std::uint32_t segments, std::size_t count) {
    color.interpolation = interpolation;
    color.segments = segments;
    color.values.assign(count, {});
    return complaint(scene) == "";
  };
  CHECK(accepts(Interpolation::kConstant, 0, 1));
  CHECK(accepts(Interpolation::kTriangle, 0, 2));
  CHECK(accepts(Interpolation::kVertex, 0, 4));
  CHECK(accepts(Interpolation::kFaceVarying, 0, 6));
  CHECK(accepts(Interpolation::kVertex, 2, 12));
  CHECK_FALSE(accepts(Interpolation::kVertex, 3, 16));
  CHECK_FALSE(accepts(Interpolation::kVertex, 2, 8));
  CHECK(complaint(scene) == "/mesh: displayColor: found 8 values; expected 3 keys x 4");
}

// Trees share the meshes as they stand, so that nobody can append the guard later on.
TEST_CASE("meshes: through the geometry's own gate, with their guard") {
  Scene scene = valid_scene();
  TriangleMesh& shape = scene.meshes[0].shape;
  SUBCASE("segments") {
    shape.segments = 3;
    CHECK(complaint(scene) == "/mesh: segments: found 3; expected 0 or a power of two up to 128");
  }
  SUBCASE("no guard") {
    shape.positions.pop_back();
    CHECK(complaint(scene) ==
          "/mesh: positions: found 4; expected 1 controls x 4 vertices, and a guard of 1");
    CHECK(validated(shape).positions.size() == 5);
  }
  SUBCASE("keys missing") {
    shape.segments = 2;
    CHECK(complaint(scene) ==
          "/mesh: positions: found 5; expected 3 controls x 4 vertices, and a guard of 1");
  }
  SUBCASE("coordinates") {
    shape.positions[2].y = kNan;
    CHECK(
        complaint(scene) ==
        "/mesh: positions: vertex 2 at control 0 has the coordinate nan; expected a finite number of at most "
        "2^60 in size");
  }
  SUBCASE("indices") {
    shape.triangles[1][0] = 4;
    CHECK(complaint(scene) == "/mesh: triangles: triangle 1 uses vertex 4; expected less than 4");
  }
}

TEST_CASE("numbers must be finite") {
  Scene scene = valid_scene();
  SUBCASE("normals") {
    scene.meshes[0].normals.values = {{0, kNan, 0}};
    CHECK(complaint(scene) == "/mesh: normals: found NaN or infinity in element 0; expected finite values");
  }
  SUBCASE("instances") {
    scene.instances[0].world_from_prototype[3].y.z = INFINITY;
    CHECK(complaint(scene) ==
          "/instances: worldFromPrototype: found NaN or infinity in element 3; expected finite values");
  }
  SUBCASE("material") {
    scene.materials[0].opacity = kNan;
    CHECK(complaint(scene) == "/material: opacity: found NaN or infinity; expected a finite number");
  }
  SUBCASE("light") {
    scene.lights[0].radiance.x = kNan;
    CHECK(complaint(scene) == "/light: radiance: found NaN or infinity; expected a finite colour");
  }
  SUBCASE("camera") {
    scene.camera.window[0].top = kNan;
    CHECK(complaint(scene) == "/camera: window: found NaN or infinity in element 0; expected finite values");
  }
}

TEST_CASE("indices must be in range") {
  Scene scene = valid_scene();
  SUBCASE("material") {
    scene.meshes[0].material = 1;
    CHECK(complaint(scene) == "/mesh: material: found index 1; expected less than 1");
  }
  SUBCASE("materials of triangles") {
    scene.meshes[0].triangle_materials.assign(scene.meshes[0].shape.triangles.size(), kNone);
    CHECK(complaint(scene).empty());
    scene.meshes[0].triangle_materials.back() = 1;
    CHECK(complaint(scene) == "/mesh: triangleMaterials: found index 1; expected less than 1");
    scene.meshes[0].triangle_materials.push_back(0);
    CHECK(complaint(scene).find("/mesh: triangleMaterials: found ") == 0);
  }
  SUBCASE("world mesh") {
    scene.world = {mesh_id(7)};
    CHECK(complaint(scene) == "scene: world: found index 7; expected less than 1");
  }
  SUBCASE("grids that are not there") {
    scene.world = {{GeometryKind::kGridMesh, 0}};
    CHECK(complaint(scene) == "scene: world: found index 0; expected less than 0");
  }
  SUBCASE("grids") {
    scene.grids.push_back({{}, dice(procedural::cube_cage(), {.level = 2})});
    Grids& grids = scene.grids.back();
    grids.shape.name = "/grids";
    scene.world.push_back({GeometryKind::kGridMesh, 0});
    CHECK(complaint(scene).empty());
    grids.normals = {Interpolation::kVertex, 0, std::vector<Vec3f>(6 * 25, Vec3f{0, 0, 1})};
    grids.display_color = {Interpolation::kTriangle, 0, std::vector<Vec3f>(6)};
    grids.grid_materials.assign(6, 0);
    CHECK(complaint(scene).empty());
    grids.grid_materials.back() = 9;
    CHECK(complaint(scene) == "/grids: gridMaterials: found index 9; expected less than 1");
    grids.grid_materials.clear();
    grids.grid_faces.resize(5);
    CHECK(complaint(scene) == "/grids: gridFaces: found 5 values; expected none or 6");
    grids.grid_faces.clear();
    grids.display_color.interpolation = Interpolation::kFaceVarying;
    CHECK(complaint(scene) ==
          "/grids: interpolation: found one value a corner; expected one a grid or point");
  }
  SUBCASE("kinds in another order") {
    scene.curves = {valid_curves()};
    scene.points.resize(1);
    scene.world = {mesh_id(0), curves_id(0), points_id(0)};
    CHECK(complaint(scene).empty());
    scene.world = {mesh_id(0), points_id(0), curves_id(0)};
    CHECK(complaint(scene) ==
          "scene: world: found kinds in another order in element 2; expected meshes before grids before "
          "curves before points");
  }
  SUBCASE("prototype's mesh") {
    scene.prototypes[0].geometry = {mesh_id(0), mesh_id(2)};
    CHECK(complaint(scene) == "/prototype: geometry: found index 2; expected less than 1");
  }
  SUBCASE("instances' prototype") {
    scene.instances[0].prototype = 5;
    CHECK(complaint(scene) == "/instances: prototype: found index 5; expected less than 1");
  }
}

TEST_CASE("curves: vertices, spans, radii, normals and primvars fit together") {
  Scene scene = valid_scene();
  scene.curves = {valid_curves()};
  scene.world = {mesh_id(0), curves_id(0)};
  REQUIRE(complaint(scene).empty());
  Curves& curves = scene.curves[0];
  SUBCASE("vertices") {
    curves.shape.vertices.pop_back();
    CHECK(complaint(scene) == "/curves: vertices: found 6; expected 1 controls x 7");
  }
  SUBCASE("a span beyond the vertices") {
    curves.shape.spans = {0, 4};
    CHECK(complaint(scene).find("/curves: spans: span 1 begins at vertex 4; expected ") == 0);
  }
  SUBCASE("spans that overlap") {
    curves.shape.spans = {0, 2};
    CHECK(complaint(scene).find("/curves: spans: span 1 begins at vertex 2; expected ") == 0);
  }
  SUBCASE("a negative radius, and one that is NaN") {
    for (const float radius : {-1.0f, kNan}) {
      curves.shape.vertices[5].radius = radius;
      CHECK(complaint(scene).find("/curves: vertices: vertex 5 at control 0 has the radius ") == 0);
    }
  }
  SUBCASE("a coordinate that is NaN, and one that is too large") {
    for (const float x : {kNan, 1e30f}) {
      curves.shape.vertices[2].p.y = x;
      CHECK(complaint(scene).find("/curves: vertices: vertex 2 at control 0 has the coordinate ") == 0);
    }
  }
  SUBCASE("normals") {
    curves.shape.shape = CurveShape::kOriented;
    CHECK(complaint(scene) == "/curves: normals: found 0; expected 7");
    curves.shape.normals.resize(7);
    curves.shape.normals[3].z = kNan;
    CHECK(complaint(scene).find("/curves: normals: found ") == 0);
  }
  SUBCASE("primvars") {
    curves.display_color.interpolation = Interpolation::kVertex;
    curves.display_color.values.resize(6);
    CHECK(complaint(scene) == "/curves: displayColor: found 6 values; expected 1 keys x 7");
    curves.display_color.interpolation = Interpolation::kFaceVarying;
    CHECK(complaint(scene).find("/curves: interpolation: found one value a corner; expected ") == 0);
  }
  SUBCASE("which curve a span is of") {
    curves.span_curves = {0};
    CHECK(complaint(scene) == "/curves: spanCurves: found 1 values; expected none or 2");
  }
}

TEST_CASE("points: vertices and primvars fit together") {
  Scene scene = valid_scene();
  scene.points.resize(1);
  Points& points = scene.points[0];
  points.shape.name = "/points";
  points.shape.point_count = 2;
  points.shape.vertices.resize(2);
  scene.world = {mesh_id(0), points_id(0)};
  REQUIRE(complaint(scene).empty());
  SUBCASE("vertices") {
    points.shape.segments = 1;
    CHECK(complaint(scene) == "/points: vertices: found 2; expected 2 controls x 2");
  }
  SUBCASE("form") {
    points.shape.segments = 3;
    CHECK(complaint(scene).find("/points: segments, degree: found 3, 1; expected ") == 0);
  }
  SUBCASE("primvars") {
    points.display_opacity.interpolation = Interpolation::kTriangle;
    points.display_opacity.values.resize(3);
    CHECK(complaint(scene) == "/points: displayOpacity: found 3 values; expected 1 keys x 2");
  }
}

TEST_CASE("instances: matrices come in whole tracks, colours one an instance") {
  Scene scene = valid_scene();
  SUBCASE("matrices") {
    scene.instances[0].world_from_prototype.resize(7);
    CHECK(complaint(scene) ==
          "/instances: worldFromPrototype: found 7 matrices; expected a multiple of 2 controls");
  }
  SUBCASE("colours") {
    scene.instances[0].display_color.resize(6);
    CHECK(complaint(scene) == "/instances: displayColor: found 6 values; expected none or 3");
  }
}

TEST_CASE("camera: window, matrix and clipping range") {
  Scene scene = valid_scene();
  Camera& camera = scene.camera;
  SUBCASE("keys") {
    camera.segments = 1;
    CHECK(complaint(scene) == "/camera: worldFromCamera: found 1 controls; expected 2");
  }
  SUBCASE("empty window") {
    camera.window[0].right = camera.window[0].left;
    CHECK(complaint(scene).find("/camera: window: found an empty window") == 0);
  }
  SUBCASE("a mirroring window is one") {
    std::swap(camera.window[0].right, camera.window[0].left);
    CHECK(complaint(scene) == "");
  }
  SUBCASE("singular matrix") {
    camera.world_from_camera[0].x = {};
    CHECK(complaint(scene) ==
          "/camera: worldFromCamera: found a singular matrix; expected one that can be inverted");
  }
  SUBCASE("reversed clipping range") {
    camera.near_clip = 10.0f;
    camera.far_clip = 1.0f;
    CHECK(complaint(scene).find("/camera: clippingRange: found 10.000000 to 1.000000") == 0);
  }
  SUBCASE("a reversed clipping range at a key") {
    camera.clip = {{10.0f, 1.0f}};
    CHECK(complaint(scene).find("/camera: clippingRange: found 10.000000 to 1.000000") == 0);
  }
  SUBCASE("keys of the clipping range") {
    camera.clip.resize(2);
    CHECK(complaint(scene) == "/camera: clippingRange: found 2 controls; expected 1");
  }
  SUBCASE("lens keys") {
    camera.lens.resize(2);
    CHECK(complaint(scene) == "/camera: lens: found 2 controls; expected 1");
  }
  SUBCASE("lens radius") {
    camera.lens = {{-1.0f, 2.0f}};
    CHECK(complaint(scene) == "/camera: lens radius: found -1.000000; expected a number of at least 0");
  }
  SUBCASE("focus distance") {
    camera.lens = {{1.0f, 0.0f}};
    CHECK(complaint(scene) == "/camera: focusDistance: found 0.000000; expected a distance above 0");
  }
  SUBCASE("no lens for parallel rays") {
    camera.projection = Projection::kOrthographic;
    camera.lens = {{1.0f, 2.0f}};
    CHECK(complaint(scene).find("/camera: lens: found one on an orthographic camera") == 0);
  }
  SUBCASE("negative near distance: orthographic only") {
    camera.near_clip = -1.0f;
    CHECK(complaint(scene) != "");
    camera.projection = Projection::kOrthographic;
    CHECK(complaint(scene) == "");
  }
}

TEST_CASE("a part without a name goes by its kind and index") {
  Scene scene = valid_scene();
  scene.lights[0].name.clear();
  scene.lights[0].angle_degrees = kNan;
  CHECK(complaint(scene).find("light 0: angle: found") == 0);
}

}  // namespace
}  // namespace msbvh
