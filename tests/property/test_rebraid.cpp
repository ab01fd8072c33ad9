// Overlapping instances that the outer tree refers to in parts (core/bvh/rebraid.h).
#include <cstring>

#include "core/base/parallel.h"
#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::check_against_oracle;

namespace {

constexpr std::uint32_t kInstances = 24;
const TimeRemap kBends{{{0.0f, 0.0f, 0.25f}, {0.3f, 0.25f, 0.5f}, {0.9f, 0.5f, 1.0f}}};
const TimeRemap kBlinks{{{0.0f, 0.0f, 0.3f, false}, {0.35f, 0.3f, 0.6f, true}, {0.65f, 0.6f, 1.0f, false}}};

BuildSettings braiding(float budget) {
  BuildSettings settings;
  settings.rebraid_budget = budget;
  settings.refit = Refit::kAlways;
  settings.keep_topology = true;
  return settings;
}

// A long closed body that swings: what parts of it are worth is plain.
std::shared_ptr<Accel> rod(const TrackForm& form, const TimeRemap& time_remap,
                           Builder builder = Builder::kMsbvh) {
  const Motion swing = rotation({0, 1, 0}, 0.5);
  auto object = std::make_shared<Accel>();
  object->add_mesh(moved(sphere(7), form, [=](const Vec3d& p, double u) {
    return swing({0.1 * p.x, 0.1 * p.y, 3.0 * p.z}, u);
  }));
  object->set_time_remap(time_remap);
  BuildSettings settings;
  settings.builder = builder;
  object->commit(settings);
  return object;
}

// Crossing each other near the middle, spinning and sliding from control to control.
std::vector<Affine3f> crossing(const TrackForm& form, std::uint64_t seed, double shift = 0.0) {
  Random random(seed);
  std::vector<Affine3f> controls;
  for (std::uint32_t i = 0; i < kInstances; ++i) {
    const Vec3d at(random.in_box({-1, -1, -1}, {1, 1, 1}));
    const Vec3d z(random.direction()), x = normalize(cross(z, Vec3d(random.direction()))), y = cross(z, x);
    const Motion spin = rotation(Vec3d(random.direction()), 0.8), slide = translation({1, 0.5, -1});
    for (std::uint32_t c = 0; c < form.controls(); ++c) {
      const double u = form.moving() ? double(c) / (form.controls() - 1) : 0.5;
      controls.push_back(Affine3f(Affine3d{spin(x, u), spin(y, u) * (i % 2 ? -1.0 : 1.0), spin(z, u),
                                           slide(at + Vec3d{shift, 0, 0}, u)}));
    }
  }
  return controls;
}

struct Crossing {
  std::shared_ptr<Accel> object;
  TrackForm form;
  TimeRemap time_remap = {};

  Accel world(double shift = 0.0) const {
    Accel accel;
    accel.add_instances(object, form, crossing(form, 4, shift), time_remap);
    return accel;
  }
  Accel committed(float budget) const {
    Accel accel = world();
    accel.commit(braiding(budget));
    return accel;
  }
};

void check_same_hits(const Accel& a, const Accel& b) {
  Random random(8);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = random_ray(random, {}, 3.0f);
    Hit hit_a, hit_b;
    CHECK(a.intersect(ray, hit_a) == b.intersect(ray, hit_b));
    CHECK(hit_a == hit_b);
    CHECK(a.occluded(ray) == b.occluded(ray));
  }
}

void check(const TrackForm& object_form, const TrackForm& form, const TimeRemap& object_time_remap,
           const TimeRemap& time_remap) {
  CAPTURE(object_form.segments);
  CAPTURE(form.segments);
  const Crossing scene{rod(object_form, object_time_remap), form, time_remap};
  const Accel whole = scene.committed(0.0f);
  CHECK(whole.statistics().references == kInstances);
  for (const float budget : {1.0f, 20.0f}) {
    const Accel parts = scene.committed(budget);
    CHECK(parts.statistics().references > kInstances);
    CHECK(parts.statistics().references <= kInstances + std::uint64_t(budget * kInstances));
    CHECK_NOTHROW(parts.verify());
    check_same_hits(whole, parts);
    check_against_oracle(parts, {}, 3.0f, 80, 31);
  }
}

}  // namespace

TEST_CASE("instances in parts equal the oracle, and themselves as a whole") {
  constexpr TrackForm kForms[] = {{0, 1}, {1, 1}, {4, 1}, {2, 3}};
  for (const TrackForm& object_form : kForms) {
    for (const TrackForm& form : kForms) check(object_form, form, {}, {});
  }
}

TEST_CASE("instances in parts under time remaps equal the oracle") {
  for (const TimeRemap& own : {TimeRemap{}, kBends, kBlinks}) {
    for (const TimeRemap& inside : {TimeRemap{}, kBends, kBlinks}) check({4, 1}, {2, 1}, inside, own);
  }
}

TEST_CASE("instances beside meshes of their tree are in parts as well") {
  const auto object = rod({2, 1}, {});
  Accel world;
  world.add_mesh(moved(grid(6), 1, translation({0, 1, 0})));
  world.add_instances(object, {1, 1}, crossing({1, 1}, 5));
  world.commit(braiding(20.0f));
  CHECK_NOTHROW(world.verify());
  check_against_oracle(world, {}, 3.0f, 120, 32);
}

TEST_CASE("parts are the same bytes on any number of threads") {
  const Crossing scene{rod({2, 1}, {}), {2, 1}};
  const auto on = [&](unsigned threads) {
    Accel accel;
    Arena(threads).execute([&] { accel = scene.committed(5.0f); });
    return accel;
  };
  const Accel one = on(1), four = on(4);
  REQUIRE(one.bvh().arena.size() == four.bvh().arena.size());
  CHECK(std::memcmp(one.bvh().arena.data(), four.bvh().arena.data(), one.bvh().arena.size()) == 0);
}

TEST_CASE("instances that nothing overlaps, and those of time slices, stay whole") {
  const auto object = rod({4, 1}, {}, Builder::kTimeSplit);
  const Accel sliced = Crossing{object, {2, 1}}.committed(20.0f);
  CHECK(sliced.statistics().references == kInstances);
  CHECK_NOTHROW(sliced.verify());
  check_against_oracle(sliced, {}, 3.0f, 80, 33);
  Accel apart;
  std::vector<Affine3f> maps(kInstances);
  for (std::uint32_t i = 0; i < kInstances; ++i) maps[i].t = {10.0f * float(i), 0, 0};
  apart.add_instances(rod({0, 1}, {}), {}, maps);
  apart.commit(braiding(20.0f));
  CHECK(apart.statistics().references == kInstances);
}

TEST_CASE("parts are refitted with the object that they are of, and found anew for another") {
  const Crossing scene{rod({2, 1}, {}), {2, 1}};
  Accel first = scene.committed(5.0f);
  Accel second = scene.world(0.3), fresh = scene.world(0.3);
  second.commit_from(first, braiding(5.0f));
  fresh.commit(braiding(0.0f));
  CHECK(second.statistics().refitted == 1);
  CHECK(second.statistics().references > kInstances);
  CHECK_NOTHROW(second.verify());
  check_same_hits(second, fresh);
  const Crossing other{rod({1, 1}, {}), {2, 1}};
  Accel third = other.world(), fresh_third = other.committed(0.0f);
  third.commit_from(second, braiding(5.0f));
  CHECK(third.statistics().built == 1);
  CHECK_NOTHROW(third.verify());
  check_same_hits(third, fresh_third);
}
