// What curves and points are, in closed form: widths, ends, joints, loops, sides, pieces.
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "tests/property/round_sets.h"

using namespace msbvh;
using namespace msbvh::property;

TEST_CASE("what has no length is not there, and a chain carries on across it") {
  // Along x to 1, nothing, then down: the outside of the corner is round as if the nothing were not there.
  CurveSet curves;
  for (const Vec3f p :
       {Vec3f{0, 0, 0}, Vec3f{0.3f, 0, 0}, Vec3f{0.6f, 0, 0}, Vec3f{1, 0, 0}, Vec3f{1, 0, 0}, Vec3f{1, 0, 0},
        Vec3f{1, 0, 0}, Vec3f{1, -0.3f, 0}, Vec3f{1, -0.6f, 0}, Vec3f{1, -1, 0}})
    curves.vertices.push_back({p, 0.1f});
  curves.vertex_count = 10;
  curves.spans = {0, 3, 6};
  const auto covered = [](const CurveSet& set, float x, float y) {
    return accel_of(set, Builder::kMsbvh).occluded({.org = {x, y, 4}, .dir = {0, 0, -1}});
  };
  CHECK(covered(curves, 1.06f, 0.06f));
  CHECK_FALSE(covered(curves, 1.09f, 0.09f));
  curves.spans = {0, 3};  // no longer down: a free end, cut straight
  CHECK_FALSE(covered(curves, 1.01f, 0.0f));
  CHECK(covered(curves, 0.99f, 0.0f));
  curves.spans = {3};
  CHECK_FALSE(covered(curves, 1.0f, 0.0f));
  CHECK_FALSE(covered(curves, 1.05f, 0.0f));
}

TEST_CASE("a loop has no seam, and one that does not close is refused") {
  CurveSet square;
  const Vec3f corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int i = 0; i < 12; ++i) {
    const auto side = static_cast<std::size_t>(i / 3);
    const Vec3f &a = corners[side], &b = corners[(side + 1) % 4];
    square.vertices.push_back({a + (b - a) * (static_cast<float>(i % 3) / 3.0f), 0.1f});
  }
  square.vertices.push_back(square.vertices[0]);
  square.vertex_count = 13;
  square.spans = {0, 3, 6, 9};
  const Ray at_seam{.org = {-0.06f, -0.06f, 4}, .dir = {0, 0, -1}};
  CHECK_FALSE(accel_of(square, Builder::kMsbvh).occluded(at_seam));
  square.loops = {{0, 3}};
  CHECK(accel_of(square, Builder::kMsbvh).occluded(at_seam));
  CHECK_THROWS_WITH_AS(
      [&] {
        CurveSet open = square;
        open.vertices[12].p.x += 0.01f;
        validate(open);
      }(),
      doctest::Contains("loops: loop 0 has spans 0 to 3; expected a whole chain"), Error);
}

TEST_CASE("what has no width is not there") {
  CurveSet curves = stick();
  for (RoundVertex& v : curves.vertices) v.radius = 0.0f;
  PointSet points;
  points.point_count = 1;
  points.vertices = {{{0, 0, 0}, 0.0f}};
  Accel accel;
  accel.add_curves(std::move(curves));
  accel.add_points(std::move(points));
  accel.commit();
  CHECK_NOTHROW(accel.verify());
  Hit hit;
  CHECK_FALSE(accel.intersect({.org = {1, 0, 4}, .dir = {0, 0, -1}}, hit));
  CHECK_FALSE(accel.occluded({.org = {0, 0, 4}, .dir = {0, 0, -1}}));
}

TEST_CASE("a ribbon's width, ends and joints") {
  const Accel accel = accel_of(stick(), Builder::kMsbvh);
  const auto hits = [&](float x, float y) {
    Hit hit;
    return accel.intersect({.org = {x, y, 4}, .dir = {0, 0, -2}}, hit) && std::abs(hit.t - 2.0f) < 1e-5f &&
           std::abs(hit.u - x / 3) < 1e-5f && std::abs(std::abs(hit.v) - std::abs(y) / 0.1f) < 1e-4f;
  };
  CHECK(hits(1.5f, 0.0f));
  CHECK(hits(1.5f, 0.099f));
  CHECK(hits(0.1f, -0.099f));
  CHECK_FALSE(hits(1.5f, 0.101f));
  CHECK_FALSE(hits(-0.01f, 0.0f));  // free ends are cut straight
  CHECK_FALSE(hits(3.01f, 0.05f));

  // A right angle: the outside of the joint is round.
  CurveSet bent = stick();
  bent.vertex_count = 7;
  for (const float y : {-1.0f, -2.0f, -3.0f}) bent.vertices.push_back({{3, y, 0}, 0.1f});
  bent.spans = {0, 3};
  const Accel corner = accel_of(bent, Builder::kMsbvh);
  const auto covered = [&](float x, float y) {
    return corner.occluded({.org = {x, y, 4}, .dir = {0, 0, -1}});
  };
  CHECK(covered(3.06f, 0.06f));
  CHECK_FALSE(covered(3.09f, 0.09f));
  CHECK(covered(2.95f, -0.05f));
}

TEST_CASE("a tube is round, and so are its ends") {
  const Accel accel = accel_of(with_shape(stick(), CurveShape::kTube, 0), Builder::kMsbvh);
  const auto distance = [&](const Vec3f& org, const Vec3f& dir) {
    Hit hit;
    return accel.intersect({.org = org, .dir = dir}, hit) ? hit.t : -1.0f;
  };
  CHECK(distance({1.5f, 0, 4}, {0, 0, -1}) == doctest::Approx(3.9));
  CHECK(distance({1.5f, 0.06f, 4}, {0, 0, -1}) == doctest::Approx(3.92));
  CHECK(distance({1.5f, 0.101f, 4}, {0, 0, -1}) < 0.0f);
  CHECK(distance({-0.06f, 0, 4}, {0, 0, -1}) == doctest::Approx(3.92));  // the cap
  CHECK(distance({-0.101f, 0, 4}, {0, 0, -1}) < 0.0f);
  CHECK(distance({-2, 0, 0}, {1, 0, 0}) == doctest::Approx(1.9));  // along it
  CHECK(distance({5, 0.06f, 0}, {-2, 0, 0}) == doctest::Approx(0.96));
  CHECK(distance({1.5f, 0, 0}, {0, 0, 1}) < 0.0f);  // from inside: it is not entered
}

TEST_CASE("a ribbon across normals has its own side, and no width along the ray") {
  CurveSet curves = with_shape(stick(), CurveShape::kOriented, 0);
  for (Vec3f& n : curves.normals) n = {0, 0, 2};
  const auto hit_of = [](const CurveSet& set, float x, float y) {
    Hit hit;
    const bool found = accel_of(set, Builder::kMsbvh).intersect({.org = {x, y, 4}, .dir = {0, 0, -2}}, hit);
    return found ? std::optional(hit) : std::nullopt;
  };
  // The tangent is x, so that b = x cross z is -y.
  const auto right = hit_of(curves, 1.5f, -0.05f);
  REQUIRE(right);
  CHECK(right->t == doctest::Approx(2.0));
  CHECK(right->u == doctest::Approx(0.5));
  CHECK(right->v == doctest::Approx(-0.5));
  CHECK(hit_of(curves, 1.5f, 0.099f));
  CHECK_FALSE(hit_of(curves, 1.5f, 0.101f));
  CHECK_FALSE(hit_of(curves, -0.01f, 0.0f));
  for (Vec3f& n : curves.normals) n = {0, 1, 1};  // half turned: seen as wide as cos 45
  const auto turned = hit_of(curves, 1.5f, 0.05f);
  REQUIRE(turned);
  CHECK(turned->t == doctest::Approx(2.025));
  CHECK_FALSE(hit_of(curves, 1.5f, 0.072f));
  for (Vec3f& n : curves.normals) n = {0, 1, 0};  // seen from its edge
  CHECK_FALSE(hit_of(curves, 1.5f, 0.001f));
}

TEST_CASE("rays without a direction, from inside a point, and behind") {
  PointSet points;
  points.point_count = 1;
  points.vertices = {{{0, 0, 0}, 2.0f}};
  const Accel accel = accel_of(points, Builder::kMsbvh);
  Hit hit;
  CHECK_FALSE(accel.intersect({.org = {0, 0, 4}, .dir = {0, 0, 0}}, hit));
  CHECK_FALSE(accel.intersect({.org = {0, 0, 4}, .dir = {0, 0, std::nanf("")}}, hit));
  CHECK_FALSE(accel.intersect({.org = {0, 0, 4}, .dir = {0, 0, 1}}, hit));
  REQUIRE(accel.intersect({.org = {0, 0, 0.5f}, .dir = {0, 0, 1}}, hit));
  CHECK(hit.t == doctest::Approx(1.5));
  REQUIRE(accel.intersect({.org = {0, 0, -4}, .tnear = 3.0f, .dir = {0, 0, 1}}, hit));
  CHECK(hit.t == doctest::Approx(6.0));
  CHECK_FALSE(accel.intersect({.org = {0, 0, -4}, .dir = {0, 0, 1}, .tfar = 1.5f}, hit));
}

TEST_CASE("long thin spans are cut to pieces, compact ones are not") {
  CurveSet diagonal = stick();
  for (RoundVertex& v : diagonal.vertices) v = {{v.p.x, v.p.x, v.p.x}, 0.01f};
  CHECK(accel_of(diagonal, Builder::kMsbvh).statistics().references == 8);
  CHECK(accel_of(diagonal, Builder::kMbvh).statistics().references == 1);
  CHECK(accel_of(stick(), Builder::kMsbvh).statistics().references == 1);
}
