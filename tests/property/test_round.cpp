// Curves and points as leaves: every kernel equals the oracle ray by ray, one by one and many at once, and
// trees hold their invariants.
#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "core/base/error.h"
#include "tests/property/round_sets.h"

using namespace msbvh;
using namespace msbvh::property;

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
