// Trees that come from the frame before: the invariants and the oracle hold however they came about.
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::check_against_oracle;

namespace {

using Meshes = std::vector<TriangleMesh>;

BuildSettings settings_for(Refit refit, Builder builder = Builder::kMsbvh) {
  BuildSettings settings;
  settings.refit = refit;
  settings.builder = builder;
  settings.keep_topology = true;
  settings.sah_time = SahTime::kCentre;  // spatial splits, however the shapes move
  settings.spatial_split_root_overlap = settings.spatial_split_node_overlap =
      0.0f;  // fragments wherever they fit
  return settings;
}

void add(Accel& accel, Meshes meshes) {
  for (TriangleMesh& m : meshes) accel.add_mesh(std::move(m));
}

Accel first_frame(Meshes meshes, const BuildSettings& settings = settings_for(Refit::kAlways)) {
  Accel accel;
  add(accel, std::move(meshes));
  accel.commit(settings);
  return accel;
}

Accel next_frame(Accel& previous, Meshes meshes,
                 const BuildSettings& settings = settings_for(Refit::kAlways)) {
  Accel accel;
  add(accel, std::move(meshes));
  accel.commit_from(previous, settings);
  return accel;
}

enum class Way { kBuilt, kRefitted, kKept };

Way way_of(const Accel& accel) {
  const BvhStatistics& s = accel.statistics();
  REQUIRE(s.built + s.refitted + s.kept == 1);
  return s.kept ? Way::kKept : s.refitted ? Way::kRefitted : Way::kBuilt;
}

// Turns, slides and bends, differently in every frame; `size` scales it all.
Motion frame_motion(std::uint64_t frame, double size = 1.0) {
  Random random(frame + 100);
  const Motion turn = rotation(Vec3d(random.direction()), 1.0 + double(frame));
  const Vec3d slide(random.in_box({-1, -1, -1}, {1, 1, 1}));
  const Motion breakpoint = wave(0.3, 2.0);
  return [=](const Vec3d& p, double u) {
    return (breakpoint(turn(p, 0.5 + 0.4 * double(frame) + u), u) + slide * u) * size;
  };
}

constexpr TrackForm kForms[] = {{1, 1}, {8, 1}, {0, 1}, {2, 3}, {128, 1}, {1, 2}};

Meshes shapes(std::uint64_t frame, const Vec3d& offset = {}) {
  const auto form = [frame](std::uint64_t i) { return kForms[(frame + i) % std::size(kForms)]; };
  return {moved(sticks(200, 1), form(0), frame_motion(frame), offset),
          moved(soup(80, 0.4f, 2), form(1), frame_motion(frame + 7), offset),
          moved(sphere(5), form(2), frame_motion(frame + 13), offset)};
}

void check_same_hits(const Accel& a, const Accel& b, float radius) {
  Random random(77);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = random_ray(random, {}, radius);
    Hit x, y;
    const bool found = a.intersect(ray, x);
    REQUIRE(found == b.intersect(ray, y));
    if (found)
      CHECK((x.t == y.t && x.geometry == y.geometry && x.triangle == y.triangle && x.instance == y.instance));
    CHECK(a.occluded(ray) == b.occluded(ray));
  }
}

constexpr std::uint32_t kCollapsed = 400;

// Long triangles along random diagonals whose third corner lies on the line of the other two (`apart` 0), or
// next to it, in the frame that the topology is built in; in the others it may be anywhere. Spatial splits
// cut them, since their boxes are large.
Meshes collapsed(std::uint64_t frame, double apart, double size, const TrackForm& form, const Vec3d& offset) {
  TriangleMesh mesh;
  Random random(5);
  for (std::uint32_t i = 0; i < kCollapsed; ++i) {
    const Vec3f a = random.in_box({-1, -1, -1}, {1, 1, 1}),
                b = a + (Vec3f{2, 2, 2} + random.direction() * 0.4f);
    const float along = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 0.37f : 1.5f;
    const Vec3f c = a + (b - a) * along;
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.vertex_count = 3 * kCollapsed;
  mesh = moved(std::move(mesh), form, frame == 0 ? translation({0.1, 0, 0}) : frame_motion(frame), {});
  for (std::size_t p = 0; p < mesh.position_count(); ++p) {
    Random own(p % mesh.vertex_count + 1000 * frame + 9);
    const bool third = p % 3 == 2;
    const Vec3d push = third ? Vec3d(own.direction()) * (frame == 0 ? apart : 1.5) : Vec3d{};
    mesh.positions[p] = Vec3f((Vec3d(mesh.positions[p]) + push) * (frame == 0 ? 1.0 : size) + offset);
  }
  return {std::move(mesh)};
}

}  // namespace

TEST_CASE("refitted trees hold the invariants and equal the oracle, at other key counts and degrees") {
  for (const Builder builder : {Builder::kMsbvh, Builder::kMbvh}) {
    for (const double offset : {0.0, 1e4}) {
      const Vec3d at{offset, -offset, offset};
      const BuildSettings settings = settings_for(Refit::kAlways, builder);
      Accel accel = first_frame(shapes(0, at), settings);
      CHECK((accel.statistics().references > accel.statistics().triangles) == (builder == Builder::kMsbvh));
      for (std::uint64_t frame = 1; frame < 6; ++frame) {
        CAPTURE(frame);
        CAPTURE(offset);
        accel = next_frame(accel, shapes(frame, at), settings);
        CHECK(way_of(accel) == Way::kRefitted);
        CHECK_NOTHROW(accel.verify());
        check_against_oracle(accel, Vec3f(at), 4.0f, 60, frame);
      }
    }
  }
}

TEST_CASE("fragments that were cut from flat triangles cover them when they are large") {
  for (const double apart : {0.0, 1e-9, 1e-6, 1e-3}) {
    for (const double size : {1e-3, 1.0, 1e3}) {
      for (const double offset : {0.0, 1e4}) {
        CAPTURE(apart);
        CAPTURE(size);
        CAPTURE(offset);
        const Vec3d at{offset, offset, -offset};
        Accel accel = first_frame(collapsed(0, apart, size, {1, 1}, at));
        REQUIRE(accel.statistics().references > accel.statistics().triangles * 5 / 4);
        for (std::uint64_t frame = 1; frame < 4; ++frame) {
          accel = next_frame(accel, collapsed(frame, apart, size, kForms[frame], at));
          CHECK(way_of(accel) == Way::kRefitted);
          CHECK_NOTHROW(accel.verify());
          check_against_oracle(accel, Vec3f(at), float(3.0 * size), 60, frame);
        }
      }
    }
  }
}

TEST_CASE("a triangle that is a point in the frame of the build") {
  const auto at_size = [](double size) {
    return Meshes{moved(sticks(60, 3), 1, [=](const Vec3d& p, double u) { return p * (size * (0.5 + u)); })};
  };
  Accel accel = first_frame(at_size(0.0));
  accel = next_frame(accel, at_size(1.0));
  CHECK(way_of(accel) == Way::kRefitted);
  CHECK_NOTHROW(accel.verify());
  check_against_oracle(accel, {}, 3.0f, 100, 3);
}

TEST_CASE("hits do not depend on how the tree came about") {
  Accel refitted = first_frame(shapes(0)), kept = first_frame(shapes(5));
  for (std::uint64_t frame = 1; frame < 6; ++frame) refitted = next_frame(refitted, shapes(frame));
  const Accel built = first_frame(shapes(5));
  kept = next_frame(kept, shapes(5));
  CHECK(way_of(kept) == Way::kKept);
  check_same_hits(refitted, built, 4.0f);
  check_same_hits(kept, built, 4.0f);
}

TEST_CASE("there and back again gives the tree that was built, byte for byte") {
  const Accel built = first_frame(shapes(0));
  Accel there = first_frame(shapes(0));
  there = next_frame(there, shapes(3));
  const Accel back = next_frame(there, shapes(0));
  CHECK(way_of(back) == Way::kRefitted);
  REQUIRE(back.bvh().arena.size() == built.bvh().arena.size());
  CHECK(std::memcmp(back.bvh().arena.data(), built.bvh().arena.data(), built.bvh().arena.size()) == 0);
  CHECK(back.statistics().sah_cost == built.statistics().sah_cost);
}

TEST_CASE("unchanged geometry keeps its tree, which outlives the frame that it was built in") {
  std::optional<Accel> accel = first_frame(shapes(4));  // 129 keys: leaves read the meshes' tracks
  const std::byte* arena = accel->bvh().arena.data();
  for (int frame = 0; frame < 3; ++frame) {
    Accel next = next_frame(*accel, shapes(4), settings_for(Refit::kAuto));
    accel.reset();
    accel.emplace(std::move(next));
    CHECK(way_of(*accel) == Way::kKept);
    CHECK(accel->bvh().arena.data() == arena);
  }
  CHECK_NOTHROW(accel->verify());
  check_against_oracle(*accel, {}, 4.0f, 60, 8);
  Accel refitted = next_frame(*accel, shapes(1));
  CHECK(way_of(refitted) == Way::kRefitted);  // the topology came along
}

TEST_CASE("another topology, or none that was kept, is built anew") {
  const auto way_after = [](Meshes meshes, const BuildSettings& settings = settings_for(Refit::kAlways)) {
    Accel before = first_frame(shapes(0));
    const Accel accel = next_frame(before, std::move(meshes), settings);
    CHECK_NOTHROW(accel.verify());
    check_against_oracle(accel, {}, 4.0f, 40, 2);
    return way_of(accel);
  };
  Meshes rewired = shapes(0), turned = shapes(1), fewer = shapes(1), other = shapes(1);
  std::swap(rewired[0].triangles[0][1], rewired[0].triangles[0][2]);  // every point stays where it was
  std::swap(turned[0].triangles[0][1], turned[0].triangles[0][2]);
  fewer.pop_back();
  other[1].triangles.pop_back();
  CHECK(way_after(shapes(1)) == Way::kRefitted);
  CHECK(way_after(rewired) == Way::kBuilt);
  CHECK(way_after(turned) == Way::kBuilt);
  CHECK(way_after(fewer) == Way::kBuilt);
  CHECK(way_after(other) == Way::kBuilt);
  CHECK(way_after(shapes(1), settings_for(Refit::kNever)) == Way::kBuilt);
  CHECK(way_after(shapes(0), settings_for(Refit::kNever)) == Way::kBuilt);
  CHECK(way_after(shapes(1), settings_for(Refit::kAlways, Builder::kMbvh)) == Way::kBuilt);

  Accel before = first_frame(shapes(0));
  CHECK(way_of(next_frame(before, shapes(1))) == Way::kRefitted);
  CHECK(way_of(next_frame(before, shapes(2))) == Way::kBuilt);  // the topology has been handed on
  CHECK_NOTHROW(before.verify());
}

TEST_CASE("a tree that has become expensive is rebuilt, unless it is to be refitted always") {
  const auto thrown = [](double far) {
    return Meshes{moved(soup(2000, 0.05f, 4), 1, [=](const Vec3d& p, double u) {
      const double phase = 40.0 * (p.x + 3.0 * p.y + 7.0 * p.z);  // neighbours part
      return p + Vec3d{std::sin(phase), std::cos(phase), std::sin(2.0 * phase)} * (far * (0.9 + 0.2 * u));
    })};
  };
  Accel a = first_frame(thrown(0.0)), b = first_frame(thrown(0.0)), c = first_frame(thrown(0.0));
  CHECK(way_of(next_frame(a, thrown(0.01), settings_for(Refit::kAuto))) == Way::kRefitted);
  const Accel rebuilt = next_frame(b, thrown(1.0), settings_for(Refit::kAuto));
  const Accel refitted = next_frame(c, thrown(1.0), settings_for(Refit::kAlways));
  CHECK(way_of(rebuilt) == Way::kBuilt);
  CHECK(way_of(refitted) == Way::kRefitted);
  CHECK(refitted.statistics().sah_cost > rebuilt.statistics().sah_cost);
  CHECK(rebuilt.statistics().refit_seconds > 0.0);
}

namespace {

struct World {
  std::shared_ptr<Accel> object = std::make_shared<Accel>();
  Accel accel;

  // `hidden`: the second set is not there at all.
  World(std::uint64_t object_frame, std::uint64_t frame, World* before, int instances = 6,
        bool hidden = false) {
    const BuildSettings settings = settings_for(Refit::kAlways);
    add(*object, {moved(sticks(30, 9), kForms[object_frame % 6], frame_motion(object_frame))});
    before ? object->commit_from(*before->object, settings) : object->commit(settings);
    add(accel, {moved(grid(6), kForms[frame % 6], frame_motion(frame))});
    Random random(frame + 1);
    const auto maps = [&random](int count) {
      std::vector<Affine3f> result;
      for (int i = 0; i < count; ++i) {
        result.push_back({{1, 0, 0}, {0, 1, 0.2f}, {0, 0, 1}, random.in_box({-4, -4, -4}, {4, 4, 4})});
      }
      return result;
    };
    accel.add_instances(object, {}, maps(instances));
    accel.add_instances(object, {1, 1}, maps(2 * instances),
                        hidden ? TimeRemap{{{0.0f, 0.0f, 1.0f, false}}} : TimeRemap{});
    before ? accel.commit_from(before->accel, settings) : accel.commit(settings);
  }

  void check() const {
    CHECK_NOTHROW(accel.verify());
    CHECK_NOTHROW(object->verify());
    check_against_oracle(accel, {}, 6.0f, 80, 4);
  }
};

}  // namespace

TEST_CASE("instances are refitted where they move, kept where they stand, built where they come and go") {
  World first(0, 0, nullptr), moving(1, 1, &first);
  CHECK(way_of(*moving.object) == Way::kRefitted);
  CHECK(way_of(moving.accel) == Way::kRefitted);
  moving.check();
  World same(1, 1, &moving);
  CHECK(way_of(*same.object) == Way::kKept);
  CHECK(way_of(same.accel) == Way::kKept);
  same.check();
  World deformed(2, 1, &same);  // the object alone: the world's boxes follow it
  CHECK(way_of(*deformed.object) == Way::kRefitted);
  CHECK(way_of(deformed.accel) == Way::kRefitted);
  deformed.check();
  World hidden(2, 3, &deformed, 6, true);
  CHECK(way_of(*hidden.object) == Way::kKept);
  CHECK(way_of(hidden.accel) == Way::kBuilt);
  hidden.check();
  World shown(2, 4, &hidden);
  CHECK(way_of(shown.accel) == Way::kBuilt);
  shown.check();
  World more(2, 4, &shown, 7);
  CHECK(way_of(more.accel) == Way::kBuilt);
  more.check();
}
