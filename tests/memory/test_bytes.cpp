// Memory use is reported, to within 10 % of what the allocator says; the scratch of a build is freed, and is
// bounded while it lasts.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <memory>
#include <string>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "tests/memory/counting_allocator.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

constexpr double kShare = 0.1;
// The records of the Accel itself and of its shared pointers, which no tree is small enough to notice but one
// of a few triangles.
constexpr double kFixedBytes = 1024.0;
// The most that a build holds at once beside the finished tree, a triangle of one tree: docs/design/build.md.
constexpr double kScratchBytes = 420.0;
constexpr double kBuilderRecords = 64e3;

using Meshes = std::vector<std::shared_ptr<const TriangleMesh>>;

std::shared_ptr<const TriangleMesh> shared(TriangleMesh mesh) {
  return std::make_shared<const TriangleMesh>(validated(std::move(mesh)));
}

TriangleMesh turning(TriangleMesh mesh, std::uint32_t segments) {
  return moved(std::move(mesh), segments, rotation({0, 1, 0.2}, 1.0));
}

// What is held from before the Accel is made until after it is committed, but not the meshes, which are there
// before.
template <typename Fill>
Accel check_bytes(const Fill& fill, const BuildSettings& settings) {
  const std::int64_t before = memory::held_bytes();
  memory::reset_peak();
  Accel accel;
  fill(accel);
  accel.commit(settings);
  const double held = static_cast<double>(memory::held_bytes() - before);
  const double peak = static_cast<double>(memory::peak_bytes() - before);
  const BvhStatistics& s = accel.statistics();
  const double reported = static_cast<double>(s.held_bytes());
  CHECK(std::abs(held - reported) <= kFixedBytes + kShare * reported);
  if (reported > 10.0 * kFixedBytes) CHECK(std::abs(held - reported) <= kShare * held);
  CHECK(s.total_bytes() == s.held_bytes() + s.vertex_bytes);
  const double primitives = static_cast<double>(s.triangles + s.instances);
  const double scratch = (peak - held) / std::max(1.0, primitives);
  if (s.triangles >= 50'000)
    MESSAGE("held: ", held / primitives, " bytes a triangle, and at most ", scratch,
            " more while it is built");
  if (settings.builder != Builder::kTimeSplit && s.max_segments <= 1)
    CHECK(peak - held <= kBuilderRecords + kScratchBytes * primitives);
  return accel;
}

void check_meshes(const char* what, const Meshes& meshes, const BuildSettings& settings = {}) {
  const std::string name = what;
  CAPTURE(name);
  check_bytes(
      [&](Accel& accel) {
        for (const auto& mesh : meshes) accel.add_mesh(mesh);
      },
      settings);
}

BuildSettings settings_for(Builder builder, bool keep_topology = false) {
  BuildSettings settings;
  settings.builder = builder;
  settings.keep_topology = keep_topology;
  return settings;
}

}  // namespace

TEST_CASE("reported bytes are the allocator's, at every key count, by every builder") {
  for (const std::uint32_t segments : {0u, 1u, 8u, 128u}) {
    const Meshes meshes{shared(turning(sphere(25), segments)), shared(turning(sticks(100, 3), segments))};
    for (const BuilderName& builder : kBuilders) {
      CAPTURE(segments);
      check_meshes(builder.name, meshes, settings_for(builder.builder));
    }
  }
}

TEST_CASE("of small trees as well, and of none") {
  check_meshes("nothing", {});
  check_meshes("one triangle", {shared(soup(1, 1.0f, 1))});
  check_meshes("100 triangles", {shared(soup(100, 0.3f, 1))});
  check_meshes("100 triangles, 129 keys", {shared(turning(soup(100, 0.3f, 1), 128))});
}

TEST_CASE("of large ones, and their builds stay within the bound") {
  check_meshes("still", {shared(sphere(225))});
  check_meshes("2 keys", {shared(turning(sphere(225), 1))});
  check_meshes("9 keys", {shared(turning(sphere(225), 8))});
  check_meshes("cut", {shared(turning(sticks(33'333, 5), 1))});
  check_meshes("incoherent", {shared(debris(200'000, 1, 2.0f, 4))});
}

TEST_CASE("of instances, moving and under time remaps") {
  auto object = std::make_shared<Accel>();
  object->add_mesh(shared(turning(sphere(8), 2)));
  object->commit();
  for (const std::uint32_t segments : {0u, 1u, 8u, 128u}) {
    CAPTURE(segments);
    Random random(7);
    std::vector<Affine3f> maps;
    for (std::uint32_t i = 0; i < 500 * key_count(segments); ++i) {
      Affine3f map;
      map.t = random.in_box({-20, -20, -20}, {20, 20, 20});
      maps.push_back(map);
    }
    check_bytes(
        [&](Accel& accel) {
          accel.add_instances(object, {segments, 1}, maps,
                              TimeRemap{{{0.0f, 0.0f, 0.5f}, {0.5f, 0.5f, 1.0f}}});
        },
        {});
  }
}

TEST_CASE("of a topology that is kept, until the next frame takes it over") {
  const Meshes first{shared(turning(sticks(2'000, 3), 2))}, second{shared(turning(sticks(2'000, 3), 4))};
  const BuildSettings settings = settings_for(Builder::kMsbvh, true);
  Accel accel = check_bytes([&](Accel& a) { a.add_mesh(first[0]); }, settings);
  CHECK(accel.statistics().topology_bytes > 0);
  const std::int64_t before = memory::held_bytes();
  Accel next;
  next.add_mesh(second[0]);
  next.commit_from(accel, settings);
  REQUIRE(next.statistics().refitted == 1);
  const BvhStatistics& s = next.statistics();
  CHECK(s.topology_bytes == accel.statistics().topology_bytes);
  const double held = static_cast<double>(memory::held_bytes() - before);
  const double reported = static_cast<double>(s.held_bytes() - s.topology_bytes);
  CHECK(std::abs(held - reported) <= kShare * reported);
}

TEST_CASE("an Accel gives back all that it held") {
  const auto mesh = shared(turning(sticks(3'000, 3), 2));
  const auto one = [&] {
    Accel accel;
    accel.add_mesh(mesh);
    accel.commit(settings_for(Builder::kMsbvh, true));
  };
  one();  // what is made once and for all
  const std::int64_t bytes = memory::held_bytes(), blocks = memory::held_blocks();
  for (int i = 0; i < 3; ++i) one();
  CHECK(memory::held_bytes() == bytes);
  CHECK(memory::held_blocks() == blocks);
}
