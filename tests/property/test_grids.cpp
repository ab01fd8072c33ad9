// Displaced subdivision patches as leaves: every kernel equals the oracle ray by ray, trees hold their
// invariants, closed surfaces do not leak, and the answers are those of the same triangles in the tree.
#include <string>
#include <utility>

#include "core/geometry/grid_triangles.h"
#include "tests/property/support.h"
#include "tests/support/cages.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::check_against_oracle;
using msbvh::property::check_many;

namespace {

struct Case {
  const char* name;
  SubdivisionMesh cage;
  Motion motion;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases = {
      {"cube, rotating", cube_cage(), rotation({0, 1, 0.2}, 2.0)},
      {"prism on pentagons, translating", prism_cage(5), translation({3, 1, 0.5})},
      {"octahedron, rotating", octahedron_cage(), rotation({1, 1, 1}, 3.0)},
      {"sheet, waving", sheet_cage(3, 4), wave(0.5, 2.0)},
  };
  return kCases;
}

GridMesh diced(const Case& c, std::uint32_t segments, const Vec3d& at, bool uneven) {
  DiceSettings settings{.level = 3, .displacement = bumps(0.08, 0.6, at)};
  if (uneven) settings.edge_level = [](std::uint32_t a, std::uint32_t b) { return 1 + (a + b) % 4; };
  return dice(moved(c.cage, {segments, 1}, c.motion, at), settings);
}

BuildSettings settings_for(Builder builder, float budget = 1.0f) {
  BuildSettings settings;
  settings.builder = builder;
  settings.spatial_split_budget = budget;
  if (budget > 1.0f) {  // what is cut is cut at the centre
    settings.spatial_split_root_overlap = settings.spatial_split_node_overlap = 0.0f;
    settings.sah_time = SahTime::kCentre;
  }
  return settings;
}

Accel accel_of_grids(std::vector<GridMesh> grids, Builder builder, float budget = 1.0f) {
  Accel accel;
  for (GridMesh& g : grids) accel.add_grids(std::move(g));
  accel.commit(settings_for(builder, budget));
  return accel;
}

}  // namespace

TEST_CASE("patches equal the oracle ray by ray") {
  for (const Case& c : cases()) {
    for (const std::uint32_t segments : {0u, 1u, 2u, 8u}) {
      for (const double offset : {0.0, 1e4, 1e6}) {
        for (const Builder builder : {Builder::kMsbvh, Builder::kMbvh}) {
          CAPTURE(std::string(c.name));
          CAPTURE(segments);
          CAPTURE(offset);
          const Vec3d at{offset, -0.5 * offset, 0.25 * offset};
          const Accel accel = accel_of_grids({diced(c, segments, at, segments % 2 == 1)}, builder);
          CHECK_NOTHROW(accel.verify());
          check_against_oracle(accel, Vec3f(at), 2.0f, 40, 17);
        }
      }
    }
  }
}

TEST_CASE("patches that spatial splits cut to pieces equal the oracle") {
  for (const std::uint32_t segments : {0u, 1u, 4u}) {
    std::vector<GridMesh> grids;
    for (const Case& c : cases()) grids.push_back(diced(c, segments, {}, false));  // all in one place
    std::uint64_t patches = 0;
    for (const GridMesh& g : grids) patches += g.patches.size();
    const Accel accel = accel_of_grids(std::move(grids), Builder::kMsbvh, 3.0f);
    CHECK(accel.statistics().references > patches + patches / 2);  // they are cut
    CHECK_NOTHROW(accel.verify());
    check_against_oracle(accel, {}, 2.5f, 80, 3);
  }
}

TEST_CASE("patches that part equal the oracle: the SAH over the shutter, and splits by velocity") {
  for (const std::uint32_t segments : {1u, 4u}) {
    Accel apart, at_centre;
    Random random(11);
    for (int i = 0; i < 30; ++i) {
      const Vec3f way = random.in_box({-4, -4, -4}, {4, 4, 4}), at = random.in_box({-2, -2, -2}, {2, 2, 2});
      const Case c{"", cube_cage(), translation(Vec3d(way))};
      for (Accel* accel : {&apart, &at_centre}) accel->add_grids(diced(c, segments, Vec3d(at), false));
      if (i % 3 != 0) continue;
      for (Accel* accel : {&apart, &at_centre}) accel->add_mesh(moved(soup(20, 0.3f, 5), segments, c.motion));
    }
    apart.commit();
    BuildSettings settings;
    settings.sah_time = SahTime::kCentre;
    at_centre.commit(settings);
    CHECK(apart.statistics().sah_cost < 0.95 * at_centre.statistics().sah_cost);  // it is another builder
    CHECK_NOTHROW(apart.verify());
    check_against_oracle(apart, {}, 5.0f, 120, 13);
  }
}

TEST_CASE("patches in trees of swept boxes, and in trees for slices of the shutter, equal the oracle") {
  std::vector<BuildSettings> ways;
  for (const Builder builder : {Builder::kSwept, Builder::kTimeSplit}) ways.push_back(settings_for(builder));
  for (const std::uint32_t slices : {2u, 4u, 16u}) {
    ways.push_back(settings_for(Builder::kMsbvh, 3.0f));
    ways.back().time_slices = slices;
  }
  for (const BuildSettings& settings : ways) {
    for (const double offset : {0.0, 1e4}) {
      const Vec3d at{offset, -0.5 * offset, 0.25 * offset};
      Accel accel;
      for (const std::uint32_t segments : {0u, 1u, 8u})
        accel.add_grids(diced(cases()[segments % 4], segments, at, false));
      if (settings.time_slices != 2) {  // curves: as many slices as segments then
        const TrackForm curved{2, 3};
        accel.add_grids(dice(moved(prism_cage(4), curved, rotation({0, 0, 1}, 0.7), at), {.level = 3}));
      }
      accel.commit(settings);
      CHECK_NOTHROW(accel.verify());
      check_against_oracle(accel, Vec3f(at), 2.5f, 100, 19);
    }
  }
}

TEST_CASE("patches are kept or refitted from frame to frame, fragments of them included") {
  BuildSettings settings = settings_for(Builder::kMsbvh, 3.0f);
  settings.keep_topology = true;
  settings.refit = Refit::kAlways;
  const auto frame = [&](double angle, std::uint32_t segments, std::size_t count) {
    Accel accel;
    for (std::size_t i = 0; i < count; ++i) {
      const Case turned{"", cases()[i].cage, rotation({0.3, 1, double(i)}, angle)};
      accel.add_grids(diced(turned, segments, {}, i % 2 == 1));
    }
    return accel;
  };
  Accel first = frame(0.5, 1, 4);
  first.commit(settings);
  CHECK(first.statistics().references > first.statistics().patches);
  Accel same = frame(0.5, 1, 4);
  same.commit_from(first, settings);
  CHECK(same.statistics().kept == 1);
  check_against_oracle(same, {}, 2.5f, 60, 3);
  Accel turned = frame(2.0, 4, 4), still = frame(-1.0, 0, 4), fewer = frame(-1.0, 0, 3);
  turned.commit_from(same, settings);
  still.commit_from(turned, settings);
  for (const Accel* accel : {&turned, &still}) {
    CHECK(accel->statistics().refitted == 1);
    CHECK_NOTHROW(accel->verify());
    check_against_oracle(*accel, {}, 2.5f, 60, 5);
  }
  fewer.commit_from(still, settings);
  CHECK(fewer.statistics().built == 1);
  check_against_oracle(fewer, {}, 2.5f, 60, 7);
}

TEST_CASE("patches, triangles, curves and instances share a tree") {
  auto object = std::make_shared<Accel>();
  object->add_grids(diced(cases()[0], 2, {}, true));
  object->add_mesh(moved(sticks(10, 1), 1, translation({0.2, 0, 0})));
  object->commit();
  Accel world;
  std::uint64_t seed = 0;
  for (const TrackForm form : {TrackForm{0, 1}, {1, 1}, {16, 1}, {1, 2}, {2, 3}}) {
    world.add_mesh(moved(soup(60, 0.3f, ++seed), form, rotation({1, 2, 3}, 1.0)));
    const double x = double(seed);
    world.add_grids(dice(moved(prism_cage(4), form, rotation({0, 0, 1}, 0.7), {x, 0, 0}), {.level = 3}));
  }
  const Affine3f maps[] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-3, 0, 0}},
                           {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-2, 1, 0}},
                           {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 3, 0}},
                           {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 3, 1}}};
  world.add_instances(object, {1, 1}, maps);
  world.commit();
  CHECK_NOTHROW(object->verify());
  CHECK_NOTHROW(world.verify());
  check_against_oracle(world, {}, 5.0f, 250, 7);
}

TEST_CASE("patches are hit where the same triangles in the tree are, to the bit") {
  for (const std::uint32_t segments : {0u, 2u}) {
    const GridMesh grids = diced(cases()[1], segments, {}, false);
    Accel triangles, patches;
    triangles.add_mesh(triangles_of(grids));
    triangles.commit();
    patches.add_grids(grids);
    patches.commit();
    for (const InstructionSet set : supported_instruction_sets()) {
      const Tracer a(triangles.bvh(), set), b(patches.bvh(), set);
      std::vector<Ray> rays;
      Random random(9);
      for (int i = 0; i < 3000; ++i) {
        const Ray& ray = rays.emplace_back(random_ray(random, {}, 2.5f));
        Hit x, y;
        REQUIRE(a.intersect(ray, x) == b.intersect(ray, y));
        CHECK(a.occluded(ray) == b.occluded(ray));
        CHECK(x.t == y.t);
        CHECK(x.triangle == y.triangle);
      }
      check_many(b, rays);
    }
  }
}

TEST_CASE("nothing leaks from closed displaced surfaces, edges of all rates included") {
  for (const double offset : {0.0, 1e3, 1e4}) {
    for (const std::uint32_t segments : {0u, 1u, 16u}) {
      const Vec3d at{offset, offset, -offset};
      const Case prism{"", prism_cage(6), rotation({1, 2, 0}, 2.0, at)};
      const auto uneven = [](std::uint32_t a, std::uint32_t b) { return 1 + (a * b + a + b) % 5; };
      SubdivisionMesh cage = moved(prism.cage, {segments, 1}, rotation({1, 2, 0}, 2.0), at);
      Accel accel;
      accel.add_grids(dice(cage, {.edge_level = uneven, .displacement = bumps(0.05, 0.5, at)}));
      accel.commit();
      for (const InstructionSet set : supported_instruction_sets()) {
        const Tracer tracer(accel.bvh(), set);
        Random random(5);
        int leaks = 0;
        for (int i = 0; i < 20000; ++i) {
          const Vec3f from = Vec3f(at) + random.in_box({-.1f, -.1f, -.1f}, {.1f, .1f, .1f});
          const Ray ray{.org = from, .dir = random.direction(), .time = random.uniform()};
          Hit hit;
          leaks += !tracer.intersect(ray, hit);
          leaks += !tracer.occluded(ray);
        }
        CHECK(leaks == 0);
      }
    }
  }
}

TEST_CASE("rays through the points themselves are not lost") {
  const GridMesh grids = diced(cases()[0], 1, {}, true);
  Accel accel;
  accel.add_grids(grids);
  accel.commit();
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(accel.bvh(), set);
    for (const Grid& g : grids.grids) {
      for (std::uint32_t r = 0; r <= g.rows; ++r) {
        for (std::uint32_t c = 0; c <= g.columns; ++c) {
          const Vec3f p = grids.point(g, r, c, 0.375f);
          CHECK(tracer.occluded({.org = {0, 0, 0}, .dir = p, .time = 0.375f}));
        }
      }
    }
  }
}
