// Compact trees have the hits that the oracle has, ray by ray, on every instruction set, and fewer bytes;
// whatever moves how, in slices, through refits and instances. The scene classes: test_compact_classes.cpp.
#include <memory>
#include <utility>

#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::accel_of;
using msbvh::property::check_against_oracle;

namespace {

BuildSettings compact(std::uint32_t slices = 0) {
  BuildSettings settings;
  settings.layout = TreeLayout::kCompact;
  settings.time_slices = slices;
  return settings;
}

}  // namespace

TEST_CASE("compact trees equal the oracle, whatever moves how") {
  for (const TrackForm form :
       {TrackForm{}, TrackForm{1, 1}, TrackForm{8, 1}, TrackForm{128, 1}, TrackForm{1, 2}, TrackForm{4, 3}}) {
    for (const double offset : {0.0, 1e4}) {
      CAPTURE(form.segments);
      CAPTURE(form.degree);
      CAPTURE(offset);
      const Vec3d at{offset, -offset, offset};
      const Accel accel = accel_of({moved(sticks(40, 1), form, rotation({0, 1, 0.2}, 2.0), at),
                                    moved(soup(60, 0.4f, 5), form, translation({0.5, 1, 0}), at)},
                                   compact());
      CHECK_NOTHROW(accel.verify());
      check_against_oracle(accel, Vec3f(at), 3.0f, 60, 19);
    }
  }
}

TEST_CASE("compact trees with still parts, and in slices of the shutter") {
  for (const std::uint32_t slices : {1u, 4u}) {
    CAPTURE(slices);
    const Accel accel = accel_of({moved(soup(300, 0.3f, 5), TrackForm{}, translation({0, 0, 0}), {}),
                                  moved(soup(60, 0.4f, 6), TrackForm{4, 1}, rotation({1, 0, 0.2}, 2.0), {})},
                                 compact(slices));
    CHECK_NOTHROW(accel.verify());
    check_against_oracle(accel, {}, 3.0f, 100, 23);
  }
}

TEST_CASE("compact trees of every builder equal the oracle") {
  for (const BuilderName& builder : kBuilders) {
    CAPTURE(std::string(builder.name));
    BuildSettings settings = compact();
    settings.builder = builder.builder;
    const Accel accel = accel_of({moved(sticks(60, 1), TrackForm{2, 1}, rotation({0, 1, 0.2}, 2.0)),
                                  moved(soup(60, 0.4f, 5), TrackForm{8, 1}, rotation({1, 0, 0}, 1.0))},
                                 settings);
    CHECK_NOTHROW(accel.verify());
    check_against_oracle(accel, {}, 3.0f, 80, 29);
  }
}

TEST_CASE("compact trees are refitted into what a build of the same boxes would be") {
  BuildSettings settings = compact();
  settings.refit = Refit::kAlways;
  settings.keep_topology = true;
  const auto frame = [](double turn) {
    std::vector<TriangleMesh> meshes;
    meshes.push_back(moved(sticks(200, 1), TrackForm{4, 1}, rotation({0, 1, 0.2}, turn)));
    return meshes;
  };
  Accel first = accel_of(frame(1.0), settings), next;
  for (TriangleMesh& mesh : frame(1.3)) next.add_mesh(std::move(mesh));
  next.commit_from(first, settings);
  CHECK(next.statistics().refitted == 1);
  CHECK_NOTHROW(next.verify());
  check_against_oracle(next, {}, 3.0f, 100, 31);

  // Another layout is another tree.
  BuildSettings full = settings;
  full.layout = TreeLayout::kFull;
  Accel other;
  for (TriangleMesh& mesh : frame(1.3)) other.add_mesh(std::move(mesh));
  other.commit_from(next, full);
  CHECK(other.statistics().built == 1);
  CHECK_NOTHROW(other.verify());
}

TEST_CASE("compact instances, under time remaps and taken apart, equal the oracle") {
  const TimeRemap breakpoints{{{0.0f, 0.0f, 0.25f}, {0.3f, 0.25f, 0.5f}, {0.9f, 0.5f, 1.0f}}};
  for (const TrackForm& form : {TrackForm{0, 1}, TrackForm{4, 1}, TrackForm{2, 3}}) {
    CAPTURE(form.segments);
    auto object = std::make_shared<Accel>();
    object->add_mesh(moved(sticks(60, 9), form, rotation({0, 0, 1}, 1.2)));
    object->set_time_remap(breakpoints);
    object->commit(compact());
    Accel world;
    world.add_mesh(moved(grid(6), TrackForm{}, translation({})));
    std::vector<Affine3f> maps(6);  // so close that they are taken apart
    for (std::size_t i = 0; i < maps.size(); ++i) maps[i].t = {0.3f * static_cast<float>(i), 0.1f, 0.2f};
    world.add_instances(object, {}, maps, breakpoints);
    world.commit(compact());
    CHECK_NOTHROW(world.verify());
    CHECK_NOTHROW(object->verify());
    check_against_oracle(world, {}, 4.0f, 100, 37);
  }
}

TEST_CASE("a compact tree shows no instance of a full one, nor the reverse") {
  for (const TreeLayout layout : {TreeLayout::kFull, TreeLayout::kCompact}) {
    BuildSettings settings;
    settings.layout = layout;
    auto object = std::make_shared<Accel>(accel_of({moved(grid(2), TrackForm{}, translation({}))}, settings));
    Accel world;
    const Affine3f identity;
    world.add_instances(object, {}, {&identity, 1});
    settings.layout = layout == TreeLayout::kFull ? TreeLayout::kCompact : TreeLayout::kFull;
    CHECK_THROWS_WITH(
        world.commit(settings),
        "accelerator: instance 0 shows a tree of another layout; expected the same in every tree");
  }
}

TEST_CASE("compact trees take fewer bytes than full ones") {
  struct Case {
    std::uint32_t segments;
    double nodes, held;  // their share of the full tree's, at most
  };
  for (const Case& c : {Case{0, 0.76, 0.75}, Case{1, 0.60, 0.5}, Case{8, 0.60, 0.25}}) {
    CAPTURE(c.segments);
    const TriangleMesh mesh = moved(sphere(24), c.segments, rotation({1, 2, 3}, 0.2), {});
    const BvhStatistics with = accel_of({mesh}, compact()).statistics();
    const BvhStatistics without = accel_of({mesh}, BuildSettings{}).statistics();
    CAPTURE(double(with.held_bytes()) / double(without.held_bytes()));
    CHECK(double(with.node_bytes) < c.nodes * double(without.node_bytes));
    CHECK(double(with.held_bytes()) < c.held * double(without.held_bytes()));
  }
}
