// The builders for comparison give the same hits: swept boxes, and a tree for each segment.
#include <memory>
#include <utility>

#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::accel_of;
using msbvh::property::check_against_oracle;

namespace {

constexpr Builder kBaselines[] = {Builder::kSwept, Builder::kTimeSplit};

void check(std::vector<TriangleMesh> meshes, Builder builder, const Vec3d& at, int rays) {
  CAPTURE(static_cast<int>(builder));
  const Accel accel = accel_of(std::move(meshes), builder);
  CHECK_NOTHROW(accel.verify());
  check_against_oracle(accel, Vec3f(at), 3.0f, rays, 17);
}

}  // namespace

TEST_CASE("baselines equal the oracle at every key count and degree") {
  for (const Builder builder : kBaselines) {
    for (const TrackForm form : {TrackForm{0, 1}, {1, 1}, {2, 1}, {8, 1}, {128, 1}, {1, 2}, {4, 3}}) {
      for (const double offset : {0.0, 1e4}) {
        CAPTURE(form.segments);
        CAPTURE(form.degree);
        const Vec3d at{offset, -offset, offset};
        check({moved(sticks(40, 1), form, rotation({0, 1, 0.2}, 2.0), at),
               moved(soup(60, 0.4f, 5), form, translation({0.5, 1, 0}), at)},
              builder, at, 60);
      }
    }
  }
}

TEST_CASE("baselines equal the oracle where tracks of all forms meet") {
  for (const Builder builder : kBaselines) {
    std::vector<TriangleMesh> meshes;
    std::uint64_t seed = 0;
    for (const TrackForm form : {TrackForm{0, 1}, {1, 1}, {4, 1}, {1, 2}, {8, 2}, {2, 3}, {32, 1}}) {
      meshes.push_back(moved(soup(40, 0.3f, ++seed), form, rotation({1, 2, 3}, 1.0)));
      meshes.push_back(moved(sticks(8, ++seed), form, translation({0.5, -1, 0})));
    }
    check(std::move(meshes), builder, {}, 200);
  }
}

TEST_CASE("baselines of moving instances of moving objects, also under time remaps, equal the oracle") {
  const TimeRemap breakpoints{{{0.0f, 0.0f, 0.25f}, {0.3f, 0.25f, 0.5f}, {0.9f, 0.5f, 1.0f}}};
  for (const Builder builder : kBaselines) {
    for (const TrackForm object_form : {TrackForm{0, 1}, {4, 1}, {2, 3}}) {
      for (const TimeRemap& time_remap : {TimeRemap{}, breakpoints}) {
        CAPTURE(object_form.segments);
        BuildSettings settings;
        settings.builder = builder;
        auto object = std::make_shared<Accel>(
            accel_of({moved(sphere(6), object_form, rotation({0, 0, 1}, 1.2))}, builder));
        Accel world;
        world.add_mesh(moved(grid(6), 2, translation({0.2, 0, 0})));
        Random random(4);
        std::vector<Affine3f> controls;
        for (int i = 0; i < 8 * 3; ++i) {
          controls.push_back({{1, 0.3f, 0}, {0, 1, 0}, {0, 0, -1}, random.in_box({-4, -4, -4}, {4, 4, 4})});
        }
        world.add_instances(object, {2, 1}, controls, time_remap);
        world.commit(settings);
        CHECK_NOTHROW(world.verify());
        CHECK_NOTHROW(object->verify());
        check_against_oracle(world, {}, 6.0f, 100, 31);
      }
    }
  }
}

TEST_CASE("segments are half-open: a ray at a key, and at the shutter's end, finds its tree") {
  const std::uint32_t segments = 8;
  const auto mesh = [] { return moved(grid(4), 8, translation({0, 8, 0})); };
  for (const Builder builder : kBaselines) {
    const Accel accel = accel_of({mesh()}, builder), plain = accel_of({mesh()});
    if (builder == Builder::kTimeSplit) CHECK(accel.bvh().slice_roots.size() == segments);
    for (const InstructionSet set : supported_instruction_sets()) {
      for (std::uint32_t i = 0; i <= 8 * segments; ++i) {
        const Ray ray{.org = {0.3f, 20, 0.2f}, .dir = {0, -1, 0}, .time = float(i) / float(8 * segments)};
        Hit a, b;
        REQUIRE(Tracer(accel.bvh(), set).intersect(ray, a));
        REQUIRE(Tracer(plain.bvh(), set).intersect(ray, b));
        CHECK((a.t == b.t && a.triangle == b.triangle));
      }
    }
  }
}

TEST_CASE("swept trees are refitted, split ones kept or built") {
  for (const Builder builder : kBaselines) {
    BuildSettings settings;
    settings.builder = builder;
    settings.refit = Refit::kAlways;
    settings.keep_topology = true;
    const auto frame = [&](double turn, Accel* previous) {
      Accel accel;
      accel.add_mesh(moved(sphere(8), 4, rotation({0, 1, 0}, turn)));
      previous ? accel.commit_from(*previous, settings) : accel.commit(settings);
      CHECK_NOTHROW(accel.verify());
      check_against_oracle(accel, {}, 3.0f, 60, 4);
      return accel;
    };
    Accel first = frame(1.0, nullptr), second = frame(2.0, &first), third = frame(2.0, &second);
    CHECK(second.statistics().refitted == (builder == Builder::kSwept));
    CHECK(third.statistics().kept == 1);
  }
}
