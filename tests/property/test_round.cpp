// Curves and points as leaves: every kernel equals the oracle ray by ray, one by one and many at once, and
// trees hold their invariants.
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "tests/property/support.h"

using namespace msbvh;
using msbvh::procedural::Random;
using msbvh::property::check_against_oracle;

namespace {

const TrackForm kForms[] = {{0, 1}, {1, 1}, {8, 1}, {1, 2}, {2, 3}};
const CurveShape kShapes[] = {CurveShape::kRibbon, CurveShape::kTube, CurveShape::kOriented};
const Builder kTrees[] = {Builder::kMsbvh, Builder::kMbvh, Builder::kSwept, Builder::kTimeSplit};

struct Look {
  const char* name;
  float step;    // from a control vertex to the next
  float radius;  // at most; some are 0 at one end
};
const Look kLooks[] = {{"hair", 0.2f, 0.03f}, {"ribbons", 0.3f, 0.15f}, {"knots", 0.6f, 0.3f}};

// The normals of oriented ones are random.
CurveSet with_shape(CurveSet curves, CurveShape shape, std::uint64_t seed) {
  curves.shape = shape;
  if (shape != CurveShape::kOriented) return curves;
  Random random(seed);
  for (std::size_t i = 0; i < curves.vertices.size(); ++i)
    curves.normals.push_back(random.direction() * random.uniform(0.5f, 2.0f));
  return curves;
}

// Chains of one to four spans that wander about the unit ball.
CurveSet wandering(const Look& look, const TrackForm& form, int chains, const Vec3f& centre, float scale,
                   std::uint64_t seed) {
  CurveSet curves;
  curves.segments = form.segments;
  curves.degree = form.degree;
  Random random(seed);
  std::vector<std::vector<RoundVertex>> controls(form.controls());
  for (int chain = 0; chain < chains; ++chain) {
    const int spans = 1 + chain % 4;
    const auto first = static_cast<std::uint32_t>(controls[0].size());
    for (int s = 0; s < spans; ++s) curves.spans.push_back(first + 3 * static_cast<std::uint32_t>(s));
    Vec3f at = random.in_box({-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f});
    for (int i = 0; i <= 3 * spans; ++i) {
      const bool tip = chain % 3 == 0 && i == 3 * spans;
      for (std::vector<RoundVertex>& control : controls) {
        const Vec3f drift = random.direction() * (form.moving() ? 0.3f : 0.0f);
        const float radius = tip ? 0.0f : look.radius * random.uniform(0.3f, 1.0f);
        control.push_back({centre + (at + drift) * scale, radius * scale});
      }
      if (chain % 5 != 4 || i % 2 == 0) at = at + random.direction() * look.step;  // else vertices coincide
    }
  }
  curves.vertex_count = static_cast<std::uint32_t>(controls[0].size());
  for (const auto& control : controls)
    curves.vertices.insert(curves.vertices.end(), control.begin(), control.end());
  return curves;
}

PointSet scattered(const TrackForm& form, int count, float radius, const Vec3f& centre, float scale,
                   std::uint64_t seed) {
  PointSet points;
  points.segments = form.segments;
  points.degree = form.degree;
  points.point_count = static_cast<std::uint32_t>(count);
  Random random(seed);
  std::vector<Vec3f> start;
  for (int i = 0; i < count; ++i) start.push_back(random.in_box({-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f}));
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    for (int i = 0; i < count; ++i) {
      const Vec3f drift = random.direction() * (form.moving() ? 0.3f : 0.0f);
      const float r = i % 7 == 6 ? 0.0f : radius * random.uniform(0.1f, 1.0f);
      points.vertices.push_back({centre + (start[static_cast<std::size_t>(i)] + drift) * scale, r * scale});
    }
  }
  return points;
}

BuildSettings settings_for(Builder builder) {
  BuildSettings settings;
  settings.builder = builder;
  return settings;
}

Accel accel_of(CurveSet curves, Builder builder) {
  Accel accel;
  accel.add_curves(std::move(curves));
  accel.commit(settings_for(builder));
  return accel;
}
Accel accel_of(PointSet points, Builder builder) {
  Accel accel;
  accel.add_points(std::move(points));
  accel.commit(settings_for(builder));
  return accel;
}

// A straight span of radius 0.1 along x, from 0 to 3.
CurveSet stick() {
  CurveSet curves;
  curves.vertex_count = 4;
  for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) curves.vertices.push_back({{x, 0, 0}, 0.1f});
  curves.spans = {0};
  return curves;
}

}  // namespace

TEST_CASE("curves equal the oracle ray by ray") {
  std::uint64_t seed = 0;
  for (const CurveShape shape : kShapes) {
    for (const Look& look : kLooks) {
      for (const TrackForm& form : kForms) {
        for (const Builder builder : kTrees) {
          CAPTURE(int(shape));
          CAPTURE(std::string(look.name));
          CAPTURE(form.segments);
          CAPTURE(form.degree);
          CAPTURE(int(builder));
          ++seed;
          const CurveSet curves = with_shape(wandering(look, form, 40, {}, 1.0f, seed), shape, seed);
          const Accel accel = accel_of(curves, builder);
          CHECK_NOTHROW(accel.verify());
          check_against_oracle(accel, {}, 1.0f, 40, seed);
        }
      }
    }
  }
}

// Chains of five spans whose vertices coincide in every way: at the ends of spans, in the middle, whole
// spans, two of them in a row, first and last ones. `looped`: the last vertex lies where the first does.
CurveSet coinciding(const TrackForm& form, bool looped, std::uint64_t seed) {
  constexpr int kChains = 48, kSpans = 5, kVertices = 3 * kSpans + 1;
  CurveSet curves;
  curves.segments = form.segments;
  curves.degree = form.degree;
  Random random(seed);
  std::vector<std::vector<RoundVertex>> controls(form.controls());
  for (int chain = 0; chain < kChains; ++chain) {
    const auto first = static_cast<std::uint32_t>(controls[0].size());
    const auto span = static_cast<std::uint32_t>(curves.spans.size());
    for (std::uint32_t s = 0; s < kSpans; ++s) curves.spans.push_back(first + 3 * s);
    if (looped) curves.loops.push_back({span, span + kSpans - 1});
    std::vector<int> place(kVertices);  // which of the chain's places each vertex is at
    const int pattern = chain % 6, where = chain / 6 % kSpans;
    for (int i = 1; i < kVertices; ++i) {
      const int within = i - 3 * where;
      const bool same = pattern == 0   ? within == 1
                        : pattern == 1 ? within == 1 || within == 2
                        : pattern == 2 ? within >= 1 && within <= 3
                        : pattern == 3 ? within >= 1 && within <= 6
                        : pattern == 4 ? within == 3 || within == 4
                                       : i % 3 != 0;
      place[static_cast<std::size_t>(i)] = place[static_cast<std::size_t>(i - 1)] + (same ? 0 : 1);
    }
    std::vector<Vec3f> at = {random.in_box({-0.7f, -0.7f, -0.7f}, {0.7f, 0.7f, 0.7f})};
    while (at.size() < kVertices) at.push_back(at.back() + random.direction() * 0.25f);
    for (std::vector<RoundVertex>& control : controls) {
      std::vector<Vec3f> drift;
      for (int i = 0; i < kVertices; ++i) drift.push_back(random.direction() * (form.moving() ? 0.2f : 0.0f));
      for (int i = 0; i < kVertices; ++i) {
        const bool back = looped && i == kVertices - 1;
        const auto p = static_cast<std::size_t>(back ? 0 : place[static_cast<std::size_t>(i)]);
        control.push_back({at[p] + drift[p], 0.12f * random.uniform(0.3f, 1.0f)});
      }
    }
  }
  curves.vertex_count = static_cast<std::uint32_t>(controls[0].size());
  for (const auto& control : controls)
    curves.vertices.insert(curves.vertices.end(), control.begin(), control.end());
  return curves;
}

TEST_CASE("curves whose vertices coincide equal the oracle, and those that close") {
  std::uint64_t seed = 300;
  for (const CurveShape shape : kShapes) {
    for (const TrackForm& form : kForms) {
      for (const bool looped : {false, true}) {
        CAPTURE(int(shape));
        CAPTURE(form.segments);
        CAPTURE(form.degree);
        CAPTURE(looped);
        ++seed;
        const CurveSet curves = with_shape(coinciding(form, looped, seed), shape, seed);
        const Accel accel = accel_of(curves, Builder::kMsbvh);
        CHECK_NOTHROW(accel.verify());
        check_against_oracle(accel, {}, 0.8f, 30, seed);
      }
    }
  }
}

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

TEST_CASE("curves far away, huge and tiny") {
  for (const CurveShape shape : kShapes) {
    for (const TrackForm& form : kForms) {
      for (const float scale : {1e-4f, 1.0f, 1e4f}) {
        for (const Vec3f& centre : {Vec3f{}, Vec3f{1e3f, -5e2f, 2e2f}}) {
          if (scale < 1.0f && centre != Vec3f{}) continue;
          CAPTURE(int(shape));
          CAPTURE(form.segments);
          CAPTURE(scale);
          CAPTURE(centre.x);
          const CurveSet curves =
              with_shape(wandering(kLooks[1], form, 30, centre * scale, scale, 77), shape, 7);
          const Accel accel = accel_of(curves, Builder::kMsbvh);
          CHECK_NOTHROW(accel.verify());
          check_against_oracle(accel, centre * scale, scale, 20, 5);
        }
      }
    }
  }
}

TEST_CASE("points equal the oracle ray by ray") {
  std::uint64_t seed = 100;
  for (const float radius : {0.06f, 0.15f, 0.6f}) {
    for (const TrackForm& form : kForms) {
      for (const Builder builder : kTrees) {
        CAPTURE(radius);
        CAPTURE(form.segments);
        CAPTURE(form.degree);
        CAPTURE(int(builder));
        const Accel accel = accel_of(scattered(form, 150, radius, {}, 1.0f, ++seed), builder);
        CHECK_NOTHROW(accel.verify());
        check_against_oracle(accel, {}, 1.0f, 150, seed);
      }
    }
  }
}

TEST_CASE("points far away, huge and tiny") {
  for (const TrackForm& form : kForms) {
    for (const float scale : {1e-4f, 1e4f}) {
      const Vec3f centre = scale > 1.0f ? Vec3f{1e6f, -1e6f, 0} : Vec3f{};
      const Accel accel = accel_of(scattered(form, 100, 0.2f, centre, scale, 7), Builder::kMsbvh);
      CHECK_NOTHROW(accel.verify());
      check_against_oracle(accel, centre, scale, 100, 5);
    }
  }
}

TEST_CASE("curves and points among triangles, as instances and in time slices") {
  for (const TrackForm& form : kForms) {
    CAPTURE(form.segments);
    CAPTURE(form.degree);
    const auto fill = [&](Accel& accel) {
      accel.add_mesh(
          procedural::moved(procedural::soup(80, 0.3f, 3), form, procedural::translation({0.2, 0.1, 0})));
      accel.add_curves(wandering(kLooks[1], form, 25, {}, 1.0f, 4));
      accel.add_points(scattered(form, 60, 0.1f, {}, 1.0f, 5));
    };
    Accel flat;
    fill(flat);
    flat.commit();
    CHECK_NOTHROW(flat.verify());
    check_against_oracle(flat, {}, 1.0f, 150, 9);

    Accel sliced;
    fill(sliced);
    BuildSettings slices;
    slices.time_slices = 4;
    sliced.commit(slices);
    CHECK_NOTHROW(sliced.verify());
    check_against_oracle(sliced, {}, 1.0f, 100, 9);

    auto object = std::make_shared<Accel>();
    fill(*object);
    object->commit();
    Accel world;
    const Affine3f turned{{0, 0.8f, 0}, {-1.2f, 0, 0}, {0, 0, -1}, {0.3f, 0, 0}},
        moved_on{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, 0.5f, 0}};
    const Affine3f placed[] = {turned, moved_on, moved_on, turned};
    world.add_instances(object, {1, 1}, placed);
    world.add_points(scattered({1, 1}, 30, 0.1f, {}, 1.0f, 6));
    world.commit();
    CHECK_NOTHROW(world.verify());
    check_against_oracle(world, {}, 1.2f, 150, 11);
  }
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

TEST_CASE("refits of curves and points equal the oracle, and unchanged ones are kept") {
  for (const TrackForm& form : {TrackForm{0, 1}, TrackForm{2, 1}}) {
    BuildSettings settings;
    settings.keep_topology = true;
    settings.refit = Refit::kAlways;
    const auto frame = [&](float offset, std::uint64_t seed) {
      Accel accel;
      CurveSet curves = wandering(kLooks[1], form, 30, {offset, 0, 0}, 1.0f, seed);
      accel.add_curves(std::move(curves));
      accel.add_points(scattered(form, 50, 0.1f, {offset, 0, 0}, 1.0f, seed));
      return accel;
    };
    Accel first = frame(0.0f, 1);
    first.commit(settings);
    Accel same = frame(0.0f, 1);
    same.commit_from(first, settings);
    CHECK(same.statistics().kept == 1);
    Accel moved = frame(0.2f, 1);
    moved.commit_from(same, settings);
    CHECK(moved.statistics().refitted == 1);
    CHECK_NOTHROW(moved.verify());
    check_against_oracle(moved, {0.2f, 0, 0}, 1.0f, 150, 3);
    // A point that had no width has some: it has no place in the old tree.
    Accel grown;
    grown.add_curves(wandering(kLooks[1], form, 30, {}, 1.0f, 1));
    PointSet points = scattered(form, 50, 0.1f, {}, 1.0f, 1);
    for (RoundVertex& v : points.vertices) v.radius = std::max(v.radius, 0.05f);
    grown.add_points(std::move(points));
    grown.commit_from(moved, settings);
    CHECK(grown.statistics().refitted == 0);
    CHECK_NOTHROW(grown.verify());
  }
}

TEST_CASE("verify() finds a curve and a point outside their boxes") {
  const auto broken = [](auto set) {
    using Set = decltype(set);
    auto shared = std::make_shared<Set>(std::move(set));
    Accel accel;
    if constexpr (std::is_same_v<Set, CurveSet>) {
      accel.add_curves(std::shared_ptr<const Set>(shared));
    } else {
      accel.add_points(std::shared_ptr<const Set>(shared));
    }
    accel.commit();
    CHECK_NOTHROW(accel.verify());
    shared->vertices[0].p.x += 0.5f;  // the tree reads the set's own vertices
    CHECK_THROWS_AS(accel.verify(), Error);
  };
  broken(wandering(kLooks[0], {1, 1}, 20, {}, 1.0f, 1));
  broken(scattered({1, 1}, 20, 0.1f, {}, 1.0f, 1));
}

TEST_CASE("long thin spans are cut to pieces, compact ones are not") {
  CurveSet diagonal = stick();
  for (RoundVertex& v : diagonal.vertices) v = {{v.p.x, v.p.x, v.p.x}, 0.01f};
  CHECK(accel_of(diagonal, Builder::kMsbvh).statistics().references == 8);
  CHECK(accel_of(diagonal, Builder::kMbvh).statistics().references == 1);
  CHECK(accel_of(stick(), Builder::kMsbvh).statistics().references == 1);
}
