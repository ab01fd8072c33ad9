// Skinning against closed forms, and bad input.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numbers>

#include "delegate/translate/rigid.h"
#include "delegate/translate/skinning.h"
#include "delegate/translate/transform_samples.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kTolerance = 1e-6f;  // single precision at coordinates of about 1

void check_near(const Vec3f& found, const Vec3f& expected) {
  INFO("found (" << found.x << ", " << found.y << ", " << found.z << "), expected (" << expected.x << ", "
                 << expected.y << ", " << expected.z << ")");
  CHECK(length(found - expected) <= kTolerance);
}

// Two points on the x axis; the first belongs to joint 0, the second to both joints by halves.
struct Arm {
  std::vector<Vec3f> points{{1, 0, 0}, {2, 0, 0}};
  std::vector<Vec3f> normals{{0, 1, 0}, {0, 1, 0}};
  std::vector<int> indices{0, 1, 0, 1};
  std::vector<float> weights{1, 0, 0.5f, 0.5f};
  std::vector<Matrix4d> joints{row_vector_matrix({}), row_vector_matrix({})};
  std::vector<SubShape> shapes;
  std::vector<float> shape_weights;
  std::vector<int> normal_points;
  SkinningMethod method = SkinningMethod::kLinear;
  Affine3d bind;
  int influences_per_point = 2;
  bool constant = false;
  std::vector<Diagnostic> diagnostics;

  SkinningInput input() const {
    SkinningInput input;
    input.path = "/arm";
    input.times01 = {0.25};
    input.points = points;
    input.normals = normals;
    input.normal_points = normal_points;
    input.method = method;
    input.joint_indices = indices;
    input.joint_weights = weights;
    input.influences_per_point = influences_per_point;
    input.constant_influences = constant;
    input.geom_bind = row_vector_matrix(bind);
    input.joints = joints;
    input.joint_count = joints.size();
    input.sub_shapes = shapes;
    input.sub_shape_weights = shape_weights;
    return input;
  }
  std::optional<SkinnedArrays> skin() {
    PrimLog log(diagnostics, "/arm");
    return skin_points(input(), log);
  }
  SkinnedArrays skinned() {
    const std::optional<SkinnedArrays> result = skin();
    for (const Diagnostic& d : diagnostics) MESSAGE(d.message);
    REQUIRE(result);
    return *result;
  }
  void check_rejected(const std::string& attribute, const std::string& found) {
    CHECK_FALSE(skin());
    check_said(Severity::kError, "/arm", attribute, found);
  }
  void check_said(Severity severity, const std::string& path, const std::string& attribute,
                  const std::string& found) const {
    REQUIRE(diagnostics.size() == 1);
    CHECK(diagnostics[0].severity == severity);
    CHECK(diagnostics[0].path == path);
    CHECK(diagnostics[0].attribute == attribute);
    INFO(diagnostics[0].message);
    CHECK(diagnostics[0].message.find(found) != std::string::npos);
    CHECK(diagnostics[0].message.find("expected") != std::string::npos);
  }
};

Affine3d scaling(double x, double y, double z) { return {{x, 0, 0}, {0, y, 0}, {0, 0, z}, {}}; }

}  // namespace

TEST_SUITE("translate: skinning") {
  TEST_CASE("joints at rest leave every point where it is, by either method") {
    for (const SkinningMethod method : {SkinningMethod::kLinear, SkinningMethod::kDualQuaternion}) {
      Arm arm;
      arm.method = method;
      const SkinnedArrays result = arm.skinned();
      CHECK(result.points[0] == arm.points);
      CHECK(result.normals[0] == arm.normals);
    }
  }

  TEST_CASE("a turned joint turns what belongs to it, points after geom_bind, normals with them") {
    for (const SkinningMethod method : {SkinningMethod::kLinear, SkinningMethod::kDualQuaternion}) {
      Arm arm;
      arm.method = method;
      arm.bind = translation({0, 3, 0});
      arm.joints.assign(2, row_vector_matrix(rotation(90)));
      const SkinnedArrays result = arm.skinned();
      check_near(result.points[0][0], {-3, 1, 0});
      check_near(result.points[0][1], {-3, 2, 0});
      check_near(result.normals[0][0], {-1, 0, 0});
    }
  }

  TEST_CASE("halves of opposite rotations: linear blending shortens by cos(a), dual quaternions do not") {
    for (const double degrees : {30.0, 60.0, 89.9}) {
      Arm arm;
      arm.joints = {row_vector_matrix(rotation(degrees)), row_vector_matrix(rotation(-degrees))};
      const float shrunk = float(2.0 * std::cos(degrees * std::numbers::pi / 180.0));
      check_near(arm.skinned().points[0][1], {shrunk, 0, 0});
      arm.method = SkinningMethod::kDualQuaternion;
      check_near(arm.skinned().points[0][1], {2, 0, 0});
    }
  }

  TEST_CASE(
      "half a turn against none: linear blending collapses to the axis, dual quaternions keep distance") {
    Arm arm;
    arm.joints = {row_vector_matrix({}), row_vector_matrix(rotation(180))};
    check_near(arm.skinned().points[0][1], {0, 0, 0});
    arm.method = SkinningMethod::kDualQuaternion;
    CHECK(length(arm.skinned().points[0][1]) == doctest::Approx(2.0));
  }

  TEST_CASE("dual quaternions blend translations evenly and take the short way round") {
    Arm arm;
    arm.method = SkinningMethod::kDualQuaternion;
    arm.joints = {row_vector_matrix(translation({0, 0, 4})), row_vector_matrix(translation({0, 2, 0}))};
    check_near(arm.skinned().points[0][1], {2, 1, 2});
    // 170 and -170 degrees lie 20 apart; their quaternions are on opposite sides.
    arm.joints = {row_vector_matrix(rotation(170)), row_vector_matrix(rotation(-170))};
    check_near(arm.skinned().points[0][1], {-2, 0, 0});
  }

  TEST_CASE("dual quaternions: scale and shear go first and are summed linearly") {
    Arm arm;
    arm.method = SkinningMethod::kDualQuaternion;
    const Affine3d turn = rotation(90);
    arm.joints = {row_vector_matrix(turn * scaling(3, 1, 1)), row_vector_matrix(turn)};
    const SkinnedArrays result = arm.skinned();
    check_near(result.points[0][0], {0, 3, 0});
    check_near(result.points[0][1], {0, 4, 0});
  }

  TEST_CASE("a mirroring joint and a joint of no size keep points finite") {
    Arm arm;
    arm.method = SkinningMethod::kDualQuaternion;
    arm.joints[0] = row_vector_matrix(scaling(-1, 1, 1));
    check_near(arm.skinned().points[0][0], {-1, 0, 0});
    arm.joints.assign(2, row_vector_matrix(scaling(0, 0, 0)));
    CHECK(is_finite(arm.skinned().points[0][1]));
    arm.method = SkinningMethod::kLinear;
    const SkinnedArrays result = arm.skinned();
    check_near(result.points[0][1], {0, 0, 0});
    check_near(result.normals[0][1], {0, 0, 0});
  }

  TEST_CASE("normals move by the inverse transpose") {
    Arm arm;
    arm.normals.assign(2, normalize(Vec3f(1, 1, 0)));
    arm.joints.assign(2, row_vector_matrix(scaling(2, 1, 1)));
    check_near(arm.skinned().normals[0][0], normalize(Vec3f(0.5f, 1, 0)));
    arm.method = SkinningMethod::kDualQuaternion;
    check_near(arm.skinned().normals[0][0], normalize(Vec3f(0.5f, 1, 0)));
  }

  TEST_CASE("faceVarying normals follow the joints of their points") {
    Arm arm;
    arm.normals.assign(3, Vec3f(0, 1, 0));
    arm.normal_points = {1, 0, 1};
    arm.joints[0] = row_vector_matrix(rotation(90));
    arm.weights = {1, 0, 0, 1};
    const SkinnedArrays result = arm.skinned();
    check_near(result.normals[0][0], {0, 1, 0});
    check_near(result.normals[0][1], {-1, 0, 0});
    check_near(result.normals[0][2], {0, 1, 0});
  }

  TEST_CASE("constant influences move every point alike; weights are not normalised") {
    Arm arm;
    arm.constant = true;
    arm.indices = {0, 1};
    arm.weights = {1, 1};
    check_near(arm.skinned().points[0][1], {4, 0, 0});
  }

  TEST_CASE("blend shapes move rest points before the joints, dense or by index, and turn normals") {
    Arm arm;
    const std::vector<Vec3f> dense{{0, 0, 1}, {0, 0, 2}}, one{{0, 8, 0}}, turned{{1, -1, 0}};
    const std::vector<int> second{1};
    arm.shapes = {{"/dense", dense, {}, {}}, {"/one", one, turned, second}};
    arm.shape_weights = {0.5f, 0.25f};
    arm.joints.assign(2, row_vector_matrix(rotation(90)));
    const SkinnedArrays result = arm.skinned();
    check_near(result.points[0][0], {0, 1, 0.5f});
    check_near(result.points[0][1], {-2, 2, 1});
    check_near(result.normals[0][0], {-1, 0, 0});
    check_near(result.normals[0][1], normalize(Vec3f(-0.75f, 0.25f, 0)));
  }

  TEST_CASE("without joints blend shapes act alone") {
    Arm arm;
    arm.indices.clear();
    arm.weights.clear();
    const std::vector<Vec3f> dense{{0, 0, 1}, {0, 0, 2}};
    arm.shapes = {{"/dense", dense, {}, {}}};
    arm.shape_weights = {2.0f};
    check_near(arm.skinned().points[0][1], {2, 0, 4});
  }

  TEST_CASE("the polar decomposition gives the map back, with a proper rotation") {
    for (const Affine3d& map : {Affine3d({2, 0, 0}, {1, 1, 0}, {0, 0.5, 3}, {7, 8, 9}),
                                Affine3d({-1, 0, 0}, {0.2, 1, 0}, {0, 0, 1}, {}), scaling(1e-2, 1e-2, 1e3)}) {
      const std::optional<PolarParts> parts = polar_parts(map);
      REQUIRE(parts);
      CHECK(parts->rotation.determinant() == doctest::Approx(1.0));
      const Affine3d product = parts->rotation * parts->stretch;
      CHECK(length(product.x - map.x) + length(product.y - map.y) + length(product.z - map.z) < 1e-12);
      CHECK(std::abs(parts->stretch.x.y - parts->stretch.y.x) < 1e-12);
      const Affine3d again = rigid_map(rigid_motion(rotation_of(parts->rotation), map.t));
      CHECK(length(again.x - parts->rotation.x) + length(again.t - map.t) < 1e-12);
    }
  }

  TEST_CASE("influences that do not fit reject the prim and are named") {
    Arm arm;
    SUBCASE("joint out of range") {
      arm.indices[2] = 2;
      arm.check_rejected("primvars:skel:jointIndices", "value 2 is 2; expected a joint from 0 to 1");
    }
    SUBCASE("negative joint") {
      arm.indices[0] = -1;
      arm.check_rejected("primvars:skel:jointIndices", "value 0 is -1");
    }
    SUBCASE("fewer weights than indices") {
      arm.weights.pop_back();
      arm.check_rejected("primvars:skel:jointWeights", "found 3 weights; expected 4");
    }
    SUBCASE("no multiple of the influences") {
      arm.influences_per_point = 3;
      arm.check_rejected("primvars:skel:jointIndices",
                         "found 4 values; expected a multiple of elementSize 3");
    }
    SUBCASE("no influences") {
      arm.influences_per_point = 0;
      arm.check_rejected("primvars:skel:jointIndices", "found elementSize 0");
    }
    SUBCASE("another number of points") {
      arm.points.push_back({});
      arm.normals.push_back({0, 1, 0});
      arm.check_rejected("primvars:skel:jointIndices", "found 4 values; expected 6");
    }
    SUBCASE("constant influences for each point") {
      arm.constant = true;
      arm.check_rejected("primvars:skel:jointIndices", "found 4 values; expected 2, 2 for the mesh");
    }
    SUBCASE("a weight that is no number") {
      arm.weights[3] = kNan;
      arm.check_rejected("primvars:skel:jointWeights", "value 3 is nan");
    }
    SUBCASE("a joint transform that is no number") {
      arm.joints[1][5] = kNan;
      arm.check_rejected("skel:skeleton", "the transform of joint 1 at shutter time 0.25");
    }
    SUBCASE("a bind transform that is no number") {
      arm.bind.t.x = kNan;
      arm.check_rejected("primvars:skel:geomBindTransform", "not a number");
    }
    SUBCASE("fewer joint transforms than joints and times") {
      SkinningInput input = arm.input();
      input.joint_count = 3;
      PrimLog log(arm.diagnostics, "/arm");
      CHECK_FALSE(skin_points(input, log));
      arm.check_said(Severity::kError, "/arm", "skel:skeleton", "found 2 joint transforms; expected 3");
    }
    SUBCASE("a point that is no number") {
      arm.points[1].y = kNan;
      arm.check_rejected("points", "value 1");
    }
  }

  TEST_CASE("a blend shape that does not fit is left out and named; the others act") {
    Arm arm;
    const std::vector<Vec3f> dense{{0, 0, 1}, {0, 0, 2}}, three(3), bad{{0, 0, 1}, {0, kNan, 2}};
    const std::vector<int> outside{0, 2};
    arm.shape_weights = {1.0f, 1.0f};
    std::string attribute, found;
    SUBCASE("indices") {
      arm.shapes = {{"/bad", dense, {}, outside}};
      attribute = "pointIndices", found = "index 1 is 2; expected a point from 0 to 1";
    }
    SUBCASE("offsets") {
      arm.shapes = {{"/bad", three, {}, {}}};
      attribute = "offsets", found = "found 3 offsets; expected 2, one a point";
    }
    SUBCASE("normal offsets") {
      arm.shapes = {{"/bad", dense, three, {}}};
      attribute = "normalOffsets", found = "found 3 offsets; expected 2";
    }
    SUBCASE("numbers") {
      arm.shapes = {{"/bad", bad, {}, {}}};
      attribute = "offsets", found = "value 1 is (0, nan, 2)";
    }
    arm.shapes.push_back({"/good", dense, {}, {}});
    const std::optional<SkinnedArrays> result = arm.skin();
    arm.check_said(Severity::kWarning, "/bad", attribute, found);
    REQUIRE(result);
    check_near(result->points[0][1], {2, 0, 2});
  }

  TEST_CASE("normals that do not fit are left out") {
    Arm arm;
    arm.normals.pop_back();
    const std::optional<SkinnedArrays> result = arm.skin();
    arm.check_said(Severity::kWarning, "/arm", "normals", "found 1 values; expected 2");
    REQUIRE(result);
    CHECK(result->normals.empty());
    CHECK(result->points[0] == arm.points);
  }

  TEST_CASE("blend shape weights that are missing or no numbers reject the prim") {
    Arm arm;
    const std::vector<Vec3f> dense{{0, 0, 1}, {0, 0, 2}};
    arm.shapes = {{"/shape", dense, {}, {}}};
    SUBCASE("missing") { arm.check_rejected("skel:blendShapes", "found 0 weights; expected 1"); }
    SUBCASE("nan") {
      arm.shape_weights = {kNan};
      arm.check_rejected("skel:blendShapes", "the weight of /shape");
    }
  }
}
