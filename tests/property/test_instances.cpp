// Instances whose transforms, or whose objects, move on curves, and under time remaps of their own.
#include <cmath>

#include "core/motion/bezier_fit.h"
#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::accel_of;
using msbvh::property::check_against_oracle;

namespace {

constexpr int kInstances = 8;

// Spinning, sliding and mirrored maps, on tracks that pass through the motion.
std::vector<Affine3f> spinning(const TrackForm& form, std::uint64_t seed) {
  Random random(seed);
  std::vector<Affine3f> controls;
  for (int i = 0; i < kInstances; ++i) {
    const Vec3d at(random.in_box({-4, -4, -4}, {4, 4, 4}));
    const Motion spin = rotation(Vec3d(random.direction()), 2.5), slide = translation({1, 0.5, -1});
    const double mirror = i % 2 ? -0.8 : 1.1;
    const auto map = [&](double u) {
      const auto column = [&](const Vec3d& e) { return spin(e * mirror, u); };
      return Affine3d{column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 0.5}), slide(at, u)};
    };
    if (!form.moving()) controls.push_back(Affine3f(map(0.5)));
    for (std::uint32_t k = 0; k < form.segments; ++k) {
      Vec3d columns[4][kMaxDegree + 1];
      for (std::uint32_t j = 0; j <= form.degree; ++j) {
        const Affine3d m = map((k + fit_nodes(form.degree)[j]) / form.segments);
        columns[0][j] = m.x, columns[1][j] = m.y, columns[2][j] = m.z, columns[3][j] = m.t;
      }
      for (Vec3d* column : columns) {
        controls_from_values([&](std::uint32_t j) -> Vec3d& { return column[j]; }, form.degree);
      }
      for (std::uint32_t j = k == 0 ? 0 : 1; j <= form.degree; ++j) {
        controls.push_back(Affine3f(Affine3d{columns[0][j], columns[1][j], columns[2][j], columns[3][j]}));
      }
    }
  }
  return controls;
}

void check(const TrackForm& object_form, const TrackForm& form, const TimeRemap& object_time_remap,
           const TimeRemap& time_remap) {
  CAPTURE(object_form.segments);
  CAPTURE(object_form.degree);
  CAPTURE(form.segments);
  CAPTURE(form.degree);
  auto object = std::make_shared<Accel>();
  object->add_mesh(moved(sticks(30, 9), object_form, rotation({0, 0, 1}, 1.2)));
  object->set_time_remap(object_time_remap);
  object->commit();
  Accel world;
  world.add_mesh(moved(grid(6), 0, translation({})));
  world.add_instances(object, form, spinning(form, 4), time_remap);
  world.commit();
  CHECK_NOTHROW(world.verify());
  CHECK_NOTHROW(object->verify());
  check_against_oracle(world, {}, 6.0f, 120, 31);
}

constexpr TrackForm kForms[] = {{0, 1}, {1, 1}, {4, 1}, {1, 2}, {2, 3}, {8, 3}};

}  // namespace

TEST_CASE("instances and objects on curves equal the oracle") {
  for (const TrackForm& object_form : kForms) {
    for (const TrackForm& form : kForms) check(object_form, form, {}, {});
  }
}

TEST_CASE("instances and objects under time remaps equal the oracle") {
  const TimeRemap breakpoints{{{0.0f, 0.0f, 0.25f}, {0.3f, 0.25f, 0.5f}, {0.9f, 0.5f, 1.0f}}};
  const TimeRemap jumps{{{0.0f, 0.0f, 0.0f}, {0.4f, 0.5f, 0.75f}, {0.7f, 1.0f, 1.0f}}};
  const TimeRemap blinks{{{0.0f, 0.0f, 0.3f, false}, {0.35f, 0.3f, 0.6f, true}, {0.65f, 0.6f, 1.0f, false}}};
  for (const TimeRemap& own : {TimeRemap{}, breakpoints, jumps, blinks}) {
    for (const TimeRemap& inside : {TimeRemap{}, breakpoints, jumps, blinks}) {
      check({4, 1}, {8, 1}, inside, own);
      check({2, 3}, {1, 3}, inside, own);
      check({0, 1}, {0, 1}, inside, own);
    }
  }
}

TEST_CASE("what is hidden is not hit, to the instant") {
  auto object = std::make_shared<Accel>(accel_of({moved(grid(2), 0, translation({}))}));
  Accel world;
  const Affine3f identity;
  world.add_instances(object, {}, {&identity, 1},
                      TimeRemap{{{0.0f, 0.0f, 0.5f, false}, {0.5f, 0.5f, 1.0f, true}}});
  world.commit();
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(world.bvh(), set);
    const auto hit_at = [&](float time) {
      return tracer.occluded({.org = {0.25f, 3, 0.25f}, .dir = {0, -1, 0}, .time = time});
    };
    CHECK_FALSE(hit_at(0.0f));
    CHECK_FALSE(hit_at(std::nextafterf(0.5f, 0.0f)));
    CHECK(hit_at(0.5f));
    CHECK(hit_at(1.0f));
  }
}

TEST_CASE("an object that is never there is in no leaf") {
  auto object = std::make_shared<Accel>(accel_of({moved(grid(2), 1, translation({1, 0, 0}))}));
  Accel world;
  const Affine3f identity;
  world.add_instances(object, {}, {&identity, 1}, TimeRemap{{{0.0f, 0.0f, 1.0f, false}}});
  world.commit();
  CHECK_NOTHROW(world.verify());
  CHECK_FALSE(world.occluded({.org = {0, 3, 0}, .dir = {0, -1, 0}, .time = 0.5f}));
}
