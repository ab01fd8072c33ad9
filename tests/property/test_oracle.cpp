// Every kernel equals the oracle ray by ray, and every tree holds its invariants: over shapes, motions, key
// counts, offsets and builders.
#include <utility>

#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::accel_of;
using msbvh::property::check_against_oracle;

namespace {

struct Case {
  const char* name;
  TriangleMesh (*mesh)(std::uint32_t segments, const Vec3d& offset);
};

const Case kCases[] = {
    {"sphere, translating",
     [](std::uint32_t s, const Vec3d& o) {
       return moved(sphere(8), s, translation({3, 1, 0.5}), o);
     }},
    {"sticks, rotating",
     [](std::uint32_t s, const Vec3d& o) {
       return moved(sticks(60, 1), s, rotation({0, 1, 0.2}, 2.0), o);
     }},
    {"grid, waving", [](std::uint32_t s, const Vec3d& o) { return moved(grid(14), s, wave(0.4, 2.0), o); }},
    {"wheel, spinning",
     [](std::uint32_t s, const Vec3d& o) {
       return moved(wheel(24, 40), s, rotation({0, 0, 1}, 3.0), o);
     }},
    {"soup, still size",
     [](std::uint32_t s, const Vec3d& o) {
       return moved(soup(300, 0.4f, 5), s, translation({0.1, 0, 0}), o);
     }},
};

}  // namespace

TEST_CASE("kernels equal the oracle ray by ray") {
  for (const Case& c : kCases) {
    for (const std::uint32_t segments : {0u, 1u, 2u, 8u, 128u}) {
      for (const double offset : {0.0, 1e4, 1e6}) {
        for (const Builder builder : {Builder::kMsbvh, Builder::kMbvh}) {
          CAPTURE(c.name);
          CAPTURE(segments);
          CAPTURE(offset);
          const Vec3d at{offset, -0.5 * offset, 0.25 * offset};
          const Accel accel = accel_of({c.mesh(segments, at)}, builder);
          CHECK_NOTHROW(accel.verify());
          check_against_oracle(accel, Vec3f(at), 3.0f, 60, 17);
        }
      }
    }
  }
}

TEST_CASE("debris with random velocities equals the oracle") {
  for (const std::uint32_t segments : {1u, 4u, 16u}) {
    const Accel accel = accel_of({debris(400, segments, 1.5f, 3)});
    CHECK_NOTHROW(accel.verify());
    check_against_oracle(accel, {}, 2.5f, 150, 23);
  }
}

TEST_CASE("tracks of different key counts share one tree") {
  std::vector<TriangleMesh> meshes;
  std::uint64_t seed = 0;
  for (const std::uint32_t segments : {0u, 1u, 2u, 4u, 32u, 128u}) {
    meshes.push_back(moved(soup(80, 0.3f, ++seed), segments, rotation({1, 2, 3}, 1.0)));
    meshes.push_back(moved(sticks(15, ++seed), segments, translation({0.5, -1, 0})));
  }
  const Accel accel = accel_of(std::move(meshes));
  CHECK_NOTHROW(accel.verify());
  check_against_oracle(accel, {}, 3.0f, 300, 5);
}

TEST_CASE("curves equal the oracle, at every degree and beside other tracks") {
  for (const Builder builder : {Builder::kMsbvh, Builder::kMbvh}) {
    for (const std::uint32_t degree : {2u, 3u}) {
      for (const std::uint32_t segments : {1u, 2u, 16u}) {
        for (const double offset : {0.0, 1e4, 1e6}) {
          CAPTURE(degree);
          CAPTURE(segments);
          CAPTURE(offset);
          const Vec3d at{offset, -offset, offset};
          const Accel accel =
              accel_of({moved(soup(150, 0.4f, 5), {segments, degree}, rotation({1, 2, 3}, 2.5), at),
                        moved(sticks(20, 6), {segments, degree}, rotation({0, 1, 1}, 1.5), at)},
                       builder);
          CHECK_NOTHROW(accel.verify());
          check_against_oracle(accel, Vec3f(at), 3.0f, 60, 5);
        }
      }
    }
  }
  std::vector<TriangleMesh> meshes;
  std::uint64_t seed = 0;
  for (const TrackForm form : {TrackForm{0, 1}, {1, 1}, {4, 1}, {1, 2}, {8, 2}, {2, 3}, {32, 3}}) {
    meshes.push_back(moved(soup(60, 0.3f, ++seed), form, rotation({1, 2, 3}, 1.0)));
    meshes.push_back(moved(sticks(12, ++seed), form, translation({0.5, -1, 0})));
  }
  const Accel accel = accel_of(std::move(meshes));
  CHECK_NOTHROW(accel.verify());
  check_against_oracle(accel, {}, 3.0f, 300, 5);
}

TEST_CASE("moving instances of moving objects equal the oracle") {
  for (const std::uint32_t object_segments : {0u, 1u, 4u}) {
    for (const std::uint32_t instance_segments : {0u, 1u, 2u, 16u}) {
      CAPTURE(object_segments);
      CAPTURE(instance_segments);
      auto object = std::make_shared<Accel>(
          accel_of({moved(sticks(30, 9), object_segments, rotation({0, 0, 1}, 1.2))}));
      Accel world;
      world.add_mesh(moved(grid(6), 0, translation({})));
      Random random(4);
      std::vector<Affine3f> keys;
      for (int i = 0; i < 8; ++i) {
        const Vec3d at = Vec3d(random.in_box({-4, -4, -4}, {4, 4, 4}));
        const Motion spin = rotation(Vec3d(random.direction()), 2.5), slide = translation({1, 0.5, -1});
        for (std::uint32_t k = 0; k < key_count(instance_segments); ++k) {
          const double u = instance_segments == 0 ? 0.5 : double(k) / instance_segments;
          const double mirror = i % 2 ? -0.8 : 1.1;
          const auto column = [&](const Vec3d& e) { return spin(e * mirror, u); };
          keys.push_back(
              Affine3f(Affine3d{column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 0.5}), slide(at, u)}));
        }
      }
      world.add_instances(object, {instance_segments, 1}, keys);
      world.commit();
      CHECK_NOTHROW(world.verify());
      CHECK_NOTHROW(object->verify());
      check_against_oracle(world, {}, 6.0f, 120, 31);
    }
  }
}

TEST_CASE("a ray in a plane of a box, with zero direction components, is not lost") {
  const Accel accel = accel_of({moved(grid(8), 1, translation({0, 1, 0}))});
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(accel.bvh(), set);
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        Ray ray;  // straight down onto the grid's own vertices, which lie on the planes of the boxes
        ray.org = {-2.0f + 0.5f * float(i), 3.0f, -2.0f + 0.5f * float(j)};
        ray.dir = {0, -1, 0};
        ray.time = 0.375f;
        Hit hit;
        CHECK(tracer.intersect(ray, hit));
      }
    }
  }
}
