// Implicit shapes: where their points lie, which way their faces look, and what is said of bad values.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numbers>

#include "delegate/translate/shape/implicit_shape.h"
#include "delegate/translate/triangulate.h"
#include "tests/translate/translate_shapes.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

constexpr double kPi = std::numbers::pi;

// Different from each other, as many as the type has parameters.
Values values_of(ImplicitKind kind) {
  Values values{0.5, 0.75, 2.0};
  values.resize(implicit_type(kind).parameters.size());
  return values;
}

struct Truth {
  double volume;
  Box3d box;
};

// Around z, from a lower circle to an upper one, with caps that reach farther out.
Truth round_truth(double bottom, double top, double height, double below, double above, double caps) {
  const double r = std::max(bottom, top), half = height / 2.0;
  return {kPi / 3.0 * height * (bottom * bottom + bottom * top + top * top) + caps,
          {{-r, -r, -half - below}, {r, r, half + above}}};
}

double ball(double radius) { return 4.0 / 3.0 * kPi * radius * radius * radius; }

// Of the true shape along z.
Truth truth_of(ImplicitKind kind, const Values& v) {
  const double half = v[0] / 2.0;
  switch (kind) {
    case ImplicitKind::kSphere:
      return {ball(v[0]), {{-v[0], -v[0], -v[0]}, {v[0], v[0], v[0]}}};
    case ImplicitKind::kCube:
      return {v[0] * v[0] * v[0], {{-half, -half, -half}, {half, half, half}}};
    case ImplicitKind::kCone:
      return round_truth(v[0], 0.0, v[1], 0.0, 0.0, 0.0);
    case ImplicitKind::kCylinder:
      return round_truth(v[0], v[0], v[1], 0.0, 0.0, 0.0);
    case ImplicitKind::kCylinder1:
      return round_truth(v[0], v[1], v[2], 0.0, 0.0, 0.0);
    case ImplicitKind::kCapsule:
      return round_truth(v[0], v[0], v[1], v[0], v[0], ball(v[0]));
    case ImplicitKind::kCapsule1:
      return round_truth(v[0], v[1], v[2], v[0], v[1], 0.5 * (ball(v[0]) + ball(v[1])));
    case ImplicitKind::kPlane:
      return {0.0, {{-half, -v[1] / 2.0, 0.0}, {half, v[1] / 2.0, 0.0}}};
  }
  return {};
}

// Positive where the faces of a closed surface look outwards.
double signed_volume(const std::vector<Triangle>& triangles, const std::vector<Vec3d>& points) {
  double volume = 0.0;
  for (const Triangle& t : triangles) volume += dot(points[t[0]], cross(points[t[1]], points[t[2]])) / 6.0;
  return volume;
}

double signed_volume(const Surface& surface, bool left_handed = false) {
  MeshInput mesh;
  mesh.face_vertex_counts = surface.counts;
  mesh.face_vertex_indices = surface.indices;
  mesh.left_handed = left_handed;
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, "/shape");
  REQUIRE(check_topology(mesh, surface.points.size(), log));
  const Triangulation found = triangulate(mesh, surface.points.size(), log);
  REQUIRE(diagnostics.empty());
  return signed_volume(found.triangles, surface.points);
}

void check_same(const Vec3d& found, const Vec3d& expected, double tolerance) {
  for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(found[axis] - expected[axis]) <= tolerance);
}

struct Made {
  explicit Made(ImplicitInput input) {
    input.path = "/shape";
    PrimLog log(diagnostics, input.path);
    shape = ImplicitShape::make(std::move(input), log);
  }
  std::vector<Diagnostic> diagnostics;
  std::optional<ImplicitShape> shape;
};

}  // namespace

TEST_SUITE("translate: implicit shapes") {
  TEST_CASE("types are found by the names of their prims, other prims are none") {
    REQUIRE(implicit_types().size() == kKinds.size());
    for (const ImplicitKind kind : kKinds) CHECK(implicit_kind(implicit_type(kind).name) == kind);
    CHECK(!implicit_kind("Mesh"));
    CHECK(!implicit_kind("sphere"));
    CHECK(implicit_type(ImplicitKind::kCapsule1).parameters[1] == "radiusTop");
    CHECK(axis_from("Y") == Axis::kY);
    CHECK(!axis_from("y"));
  }

  TEST_CASE("a sphere's points lie its radius away from the middle") {
    for (const int sides : {8, 48, 384}) {
      for (const double radius : {1.0, 2.5e-6, 3.0e7}) {
        const Surface sphere = implicit_surface(ImplicitKind::kSphere, Values{radius}, Axis::kY, sides);
        CHECK(sphere.points.size() == std::size_t(sides * (sides / 2 + 1)));
        CHECK(sphere.counts.size() == std::size_t(sides * (sides / 2)));
        double worst = 0.0;
        for (const Vec3d& p : sphere.points) worst = std::max(worst, std::abs(length(p) - radius));
        CHECK(worst <= 1e-12 * radius);
      }
    }
  }

  TEST_CASE("a cone's points lie on its side and in its bottom") {
    const double radius = 1.5, height = 4.0;
    const Surface cone = implicit_surface(ImplicitKind::kCone, Values{radius, height}, Axis::kZ, 24);
    CHECK(cone.points.size() == 6 * 24);  // Three parts with vertices of their own.
    for (const Vec3d& p : cone.points) {
      const double around = std::hypot(p.x, p.y);
      const bool on_side = std::abs(around - radius * (0.5 - p.z / height)) <= 1e-12;
      const bool in_bottom = p.z == -height / 2.0 && around == 0.0;
      CHECK((on_side || in_bottom));
    }
  }

  TEST_CASE("a capsule's points lie on its caps, which the cylinder between them joins") {
    const double bottom = 0.5, top = 0.75, half = 1.0;
    const Surface capsule =
        implicit_surface(ImplicitKind::kCapsule1, Values{bottom, top, 2.0 * half}, Axis::kZ, 32);
    CHECK(capsule.points.size() == 32 * 2 * 9);
    for (const Vec3d& p : capsule.points) {
      const bool below = p.z <= -half;
      const double away = length(p - Vec3d{0.0, 0.0, below ? -half : half});
      CHECK(std::abs(away - (below ? bottom : top)) <= 1e-12);
    }
  }

  TEST_CASE("faces look outwards, and the volume is the true one's") {
    for (const ImplicitKind kind : kKinds) {
      const Values values = values_of(kind);
      for (const Axis axis : kAxes) {
        const Surface surface = implicit_surface(kind, values, axis, 384);
        const double volume = signed_volume(surface), expected = truth_of(kind, values).volume;
        CAPTURE(implicit_type(kind).name);
        CHECK(volume == doctest::Approx(expected).epsilon(2e-4));
        CHECK(signed_volume(surface, true) == -volume);
      }
    }
  }

  TEST_CASE("a negative radius turns a shape inside out") {
    CHECK(signed_volume(implicit_surface(ImplicitKind::kSphere, Values{-1.0}, Axis::kZ, 384)) ==
          doctest::Approx(-ball(1.0)).epsilon(2e-4));
  }

  TEST_CASE("the fewest sides reach as far along each axis as the true shape does") {
    for (const ImplicitKind kind : kKinds) {
      if (kind == ImplicitKind::kPlane) continue;
      const Values values = values_of(kind);
      const Box3d expected = truth_of(kind, values).box;
      for (const Axis axis : kAxes) {
        const Box3d found = box_of(implicit_surface(kind, values, axis, 8));
        check_same(found.lo, turned(expected.lo, axis), 1e-15);
        check_same(found.hi, turned(expected.hi, axis), 1e-15);
      }
    }
  }

  TEST_CASE("a plane's width lies along x, or z for the axis x; its length along y, or z for the axis y") {
    const auto plane = [](Axis axis) {
      return implicit_surface(ImplicitKind::kPlane, Values{6.0, 2.0}, axis, 0);
    };
    CHECK(box_of(plane(Axis::kX)) == Box3d{{0, -1, -3}, {0, 1, 3}});
    CHECK(box_of(plane(Axis::kY)) == Box3d{{-3, 0, -1}, {3, 0, 1}});
    CHECK(box_of(plane(Axis::kZ)) == Box3d{{-3, -1, 0}, {3, 1, 0}});
    for (const Axis axis : kAxes) {
      const std::vector<Vec3d> p = plane(axis).points;
      CHECK(normalize(cross(p[1] - p[0], p[2] - p[0])) == turned({0, 0, 1}, axis));
    }
  }

  TEST_CASE("points are linear in every parameter, the faces the same") {
    for (const ImplicitKind kind : kKinds) {
      const Values from = values_of(kind);
      Values to = from, between = from;
      for (std::size_t i = 0; i < to.size(); ++i) {
        to[i] = 3.0 - from[i];
        between[i] = 0.75 * from[i] + 0.25 * to[i];
      }
      const Surface a = implicit_surface(kind, from, Axis::kX, 16),
                    b = implicit_surface(kind, to, Axis::kX, 16);
      const Surface middle = implicit_surface(kind, between, Axis::kX, 16);
      CHECK(a.indices == b.indices);
      CHECK(a.counts == b.counts);
      for (std::size_t i = 0; i < a.points.size(); ++i) {
        check_same(middle.points[i], a.points[i] * 0.75 + b.points[i] * 0.25, 1e-14);
      }
    }
  }

  TEST_CASE("a shape over the shutter is as large as at its largest") {
    const Made made({"", ImplicitKind::kCone, "X", {{1.0, 2.0}, {-3.0, 1.0}, {0.5, 4.0}}});
    REQUIRE(made.shape);
    CHECK(made.diagnostics.empty());
    CHECK(made.shape->time_count() == 3);
    CHECK(made.shape->radius() == 3.0);
    check_same(made.shape->box(8).lo, {-2, -3, -3}, 1e-15);
    check_same(made.shape->box(8).hi, {2, 3, 3}, 1e-15);
    check_same(made.shape->surface(2, 8).points[8], {-2.0, 0.5, 0.0},
               1e-15);  // The first of its bottom's edge.
    CHECK(Made({"", ImplicitKind::kCube, "Z", {{2.0}}}).shape->radius() == 0.0);
  }

  TEST_CASE("a parameter that is no number, or too large, is named with its value") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::pair<double, std::string> cases[] = {
        {nan, "nan"}, {-nan, "nan"}, {-INFINITY, "-inf"}, {1.23456789e20, "1.23457e+20"}};
    for (const auto& [value, text] : cases) {
      const Made made({"", ImplicitKind::kCapsule, "W", {{1.0, 2.0}, {1.0, value}}});
      CHECK(!made.shape);
      REQUIRE(made.diagnostics.size() == 1);
      CHECK(made.diagnostics[0].severity == Severity::kError);
      CHECK(made.diagnostics[0].path == "/shape");
      CHECK(made.diagnostics[0].attribute == "height");
      CHECK(made.diagnostics[0].message ==
            "found " + text + ", expected a finite number of at most 2^60 in size");
    }
    CHECK(Made({"", ImplicitKind::kCapsule, "Z", {{0x1p60, -0x1p60}}}).shape);
  }

  TEST_CASE("an unknown axis counts as z") {
    const Made made({"", ImplicitKind::kCone, "W", {{1.0, 4.0}}});
    REQUIRE(made.shape);
    CHECK(made.shape->box(8).hi.z == 2.0);
    REQUIRE(made.diagnostics.size() == 1);
    CHECK(made.diagnostics[0].severity == Severity::kWarning);
    CHECK(made.diagnostics[0].attribute == "axis");
    CHECK(made.diagnostics[0].message == "found 'W', expected X, Y or Z; took Z");
  }
}
