// Implicit shapes in numbers: how many sides they have by their size in pixels, and which of them can share a
// mesh.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <random>

#include "delegate/translate/shape/crowd.h"
#include "delegate/translate/shape/sides.h"
#include "delegate/translate/transform_samples.h"
#include "tests/translate/translate_shapes.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

int sides_of(double radius_pixels, double silhouette) {
  return sides_for(std::vector{radius_pixels}, silhouette).front();
}

// How far the faces of a sphere of radius 1 lie inside of it: 1 less the distance of the nearest plane.
double measured_stray(int sides) {
  const Surface sphere = implicit_surface(ImplicitKind::kSphere, Values{1.0}, Axis::kZ, sides);
  double nearest = 1.0;
  for (std::size_t face = 0; face < sphere.counts.size(); ++face) {
    const auto corner = [&](std::size_t i) {
      return sphere.points[std::size_t(sphere.indices[4 * face + i])];
    };
    const Vec3d normal = cross(corner(2) - corner(0), corner(3) - corner(1));
    if (length(normal) > 1e-9) nearest = std::min(nearest, std::abs(dot(normalize(normal), corner(0))));
  }
  return 1.0 - nearest;
}

// A pinhole at the origin that sees a pixel of 0.01 at unit distance.
const PixelSize kEye({{0, 0, 0}, {0, 0, 0}}, true, 0.01, 0.1);
constexpr Box3d kUnitBox{{-1, -1, -1}, {1, 1, 1}};

double radius_in_pixels(ImplicitKind kind, const std::vector<Matrix4d>& over_time, double radius = 1.0) {
  return radii_in_pixels(kind, radius, kUnitBox, over_time, 1, kEye).front();
}

Matrix4d placed(double scale, double distance) {
  return matrix_of(scaled(scale, scale, scale, {0, 0, -distance}));
}

std::vector<bool> instances(const std::vector<Matrix4d>& matrices, std::size_t count) {
  return can_be_instances(matrices, count, {}, {});
}

}  // namespace

TEST_SUITE("translate: implicit shapes in numbers") {
  TEST_CASE("the sides are the fewest whose sagitta the silhouette allows, twice that of a chord") {
    for (const auto& [complexity, silhouette] : kSilhouettes) {
      for (double radius = 0.01; radius < 1e4; radius *= 1.37) {
        const int sides = sides_of(radius, silhouette);
        CHECK((sides == kSideCounts.back() || stray_of(sides) * radius <= silhouette));
        for (const int fewer : kSideCounts) {
          if (fewer < sides) CHECK(stray_of(fewer) * radius > silhouette);
        }
      }
    }
    CHECK(sides_of(0.1 / stray_of(24), 0.1) == 24);  // Just enough.
    CHECK(stray_of(4) == doctest::Approx(2.0 - std::sqrt(2.0)));
  }

  TEST_CASE("a sphere's faces stray by no more than that") {
    for (const int sides : kSideCounts) {
      CHECK(measured_stray(sides) <= stray_of(sides) * 1.0001);
      CHECK(measured_stray(sides) >= stray_of(sides) * 0.9);
    }
  }

  TEST_CASE("what is larger than any image has the most sides, what nobody knows the size of has a few") {
    CHECK(sides_of(1e9, 0.1) == 384);
    CHECK(sides_of(kInfinity, 0.1) == 384);
    CHECK(sides_of(0.0, 0.1) == 8);
    CHECK(sides_of(kNan, 0.1) == kUnmeasuredSides);
    const int counts[] = {12, 20};
    CHECK(sides_for(std::vector{0.0, 1e9}, 0.1, counts) == std::vector<int>{12, 20});
  }

  TEST_CASE("a radius in pixels is that at the nearest place of the shutter") {
    const auto sphere = ImplicitKind::kSphere, cone = ImplicitKind::kCone;
    // 8 units away, a pixel is 0.08 wide.
    CHECK(radius_in_pixels(sphere, {placed(2.0, 10.0)}) == doctest::Approx(25.0));
    CHECK(radius_in_pixels(cone, {placed(2.0, 10.0)}) == doctest::Approx(25.0));
    CHECK(radius_in_pixels(sphere, {placed(2.0, 10.0), placed(2.0, 5.0)}) == doctest::Approx(200.0 / 3.0));
    CHECK(radius_in_pixels(cone, {placed(2.0, 10.0), placed(2.0, 5.0)}) == doctest::Approx(200.0 / 3.0));
    CHECK(radius_in_pixels(sphere, {placed(1.0, 10.0)}, 2.0) == doctest::Approx(25.0));
  }

  TEST_CASE("a sphere around the eye is as far away as its inside") {
    CHECK(radius_in_pixels(ImplicitKind::kSphere, {placed(100.0, 0.0)}) == doctest::Approx(100.0));
    CHECK(radius_in_pixels(ImplicitKind::kCone, {placed(100.0, 0.0)}) ==
          doctest::Approx(100.0 / (0.01 * 0.1)));
  }

  TEST_CASE("each of many shapes has its own size; that of some is not known") {
    Matrix4d broken = placed(1.0, 10.0);
    broken[13] = kNan;
    const std::vector<Matrix4d> matrices{
        placed(2.0, 10.0), broken, placed(1.0, 3.0), placed(2.0, 10.0), placed(1.0, 10.0), placed(1.0, 5.0)};
    const std::vector<double> found =
        radii_in_pixels(ImplicitKind::kSphere, 1.0, kUnitBox, matrices, 3, kEye);
    REQUIRE(found.size() == 3);
    CHECK(found[0] == doctest::Approx(25.0));
    CHECK(std::isnan(found[1]));
    CHECK(found[2] == doctest::Approx(50.0));
    CHECK(std::isnan(radius_in_pixels(ImplicitKind::kCube, {placed(1.0, 10.0)}, 0.0)));
  }

  TEST_CASE("stretches bound what a matrix does to lengths, exactly where its rows are orthogonal") {
    const Stretch exact = stretch_of(matrix_of({{0, 3, 0}, {0, 0, -0.5}, {2, 0, 0}, {7, 8, 9}}));
    CHECK(exact.most == 3.0);
    CHECK(exact.least == 0.5);
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    const auto vector = [&] { return Vec3d{normal(random), normal(random), normal(random)}; };
    for (int i = 0; i < 200; ++i) {
      const Affine3d map{vector(), vector(), vector(), {}};
      const Stretch bounds = stretch_of(matrix_of(map));
      for (int j = 0; j < 50; ++j) {
        const double stretched = length(map.vector(normalize(vector())));
        CHECK(stretched <= bounds.most * (1.0 + 1e-12));
        CHECK(stretched >= bounds.least * (1.0 - 1e-12));
      }
    }
  }

  TEST_CASE("the unit shape under its scale is the shape") {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(0.1, 3.0);
    for (const ImplicitKind kind : kKinds) {
      for (int i = 0; i < 30; ++i) {
        Values values;
        while (values.size() < implicit_type(kind).parameters.size()) values.push_back(uniform(random));
        const Axis axis = kAxes[std::size_t(i % 3)];
        const std::optional<UnitForm> form = unit_form(kind, values, axis);
        REQUIRE(form);
        const Affine3d map = affine_from(shape_from_unit(*form));
        const Surface unit = implicit_surface(kind, form->parameters, Axis::kZ, 16);
        const Surface shape = implicit_surface(kind, values, axis, 16);
        double worst = 0.0;
        for (std::size_t p = 0; p < shape.points.size(); ++p) {
          worst = std::max(worst, length(map.point(unit.points[p]) - shape.points[p]));
        }
        CHECK(worst <= 1e-12);
      }
    }
  }

  TEST_CASE(
      "only ratios part the unit forms of capsules and tapered cylinders, and nothing those of others") {
    const auto parameters = [](ImplicitKind kind, const Values& values) {
      return unit_form(kind, values, Axis::kZ)->parameters;
    };
    CHECK(parameters(ImplicitKind::kCylinder, {0.3, 7.0}) == parameters(ImplicitKind::kCylinder, {2.0, 0.1}));
    CHECK(parameters(ImplicitKind::kCapsule, {0.5, 2.0}) == Values{1.0, 4.0});
    CHECK(parameters(ImplicitKind::kCapsule1, {0.5, 2.0, 4.0}) == Values{0.25, 1.0, 2.0});
    CHECK(parameters(ImplicitKind::kCylinder1, {4.0, 0.0, 3.0}) == Values{1.0, 0.0, 1.0});
  }

  TEST_CASE("what is flat, negative, too large or no number has no unit form") {
    const auto has_form = [](ImplicitKind kind, const Values& values) {
      return unit_form(kind, values, Axis::kY).has_value();
    };
    for (const double bad : {0.0, -1.0, kNan, kInfinity, 0x1.1p60}) {
      CHECK(!has_form(ImplicitKind::kSphere, {bad}));
      CHECK(!has_form(ImplicitKind::kCone, {1.0, bad}));
      CHECK(!has_form(ImplicitKind::kPlane, {bad, 1.0}));
      CHECK(!has_form(ImplicitKind::kCapsule, {bad, 1.0}));
    }
    CHECK(has_form(ImplicitKind::kSphere, {0x1p60}));
    CHECK(has_form(ImplicitKind::kCapsule, {1.0, 0.0}));
    CHECK(!has_form(ImplicitKind::kCapsule1, {0.0, 0.0, 1.0}));
    CHECK(!has_form(ImplicitKind::kCylinder1, {0.0, 0.0, 1.0}));
  }

  TEST_CASE("a needle, whose unit shape would be too long, has no unit form") {
    for (const Values& values : {Values{1e-19, 1.0}, Values{0x1p-1074, 1.0}}) {
      CHECK(!unit_form(ImplicitKind::kCapsule, values, Axis::kZ));
      CHECK(!unit_form(ImplicitKind::kCapsule1, Values{values[0], 0.0, values[1]}, Axis::kZ));
    }
    CHECK(unit_form(ImplicitKind::kCapsule, Values{0x1p-60, 1.0}, Axis::kZ));
  }

  TEST_CASE("instances stand for shapes that are never flat, mirrored ones too") {
    const Matrix4d upright = matrix_of(scaled(2, 3, 4, {5, 6, 7})), mirrored = matrix_of(scaled(-2, 3, 4));
    const Matrix4d flat = matrix_of(scaled(2, 3, 0)), thin = matrix_of(scaled(1, 1, 1e-3));
    CHECK(instances({upright, mirrored, flat, thin}, 4) == std::vector{true, true, false, true});
    // Two times: from one side to the other, a shape is flat in between.
    CHECK(instances({upright, mirrored, upright, mirrored, mirrored, flat}, 3) ==
          std::vector{false, true, false});
  }

  TEST_CASE("instances stand for shapes under affine matrices of usable size, of usable colours") {
    const Matrix4d sound = matrix_of({});
    std::vector<Matrix4d> matrices(4, sound);
    matrices[0][7] = 1e-9;
    matrices[1][12] = 0x1.1p60;
    matrices[2][5] = kNan;
    CHECK(instances(matrices, 4) == std::vector{false, false, false, true});
    const std::vector<Matrix4d> alike(3, sound);
    const std::vector<Vec3f> colors{{0, 1, 65504.0f}, {0, 1, 65536.0f}, {0, float(kNan), 0}};
    CHECK(can_be_instances(alike, 3, colors, 0.5f) == std::vector{true, false, false});
    CHECK(can_be_instances(alike, 3, {}, float(kNan)) == std::vector{false, false, false});
  }
}
