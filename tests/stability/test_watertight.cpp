// The first promise: a closed moving mesh does not leak, at any key count, position and instruction set.
#include <algorithm>
#include <atomic>

#include "core/base/parallel.h"
#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;
using msbvh::property::accel_of;

namespace {

// Rays from inside the sphere, at their time, in every direction: each must hit.
std::uint64_t count_misses(const Accel& accel, InstructionSet set, const Motion& motion, const Vec3d& offset,
                           std::uint64_t rays) {
  const Tracer tracer(accel.bvh(), set);
  constexpr std::uint64_t kChunk = 1 << 14;
  std::atomic<std::uint64_t> misses{0};
  parallel_for((rays + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    Random random(chunk + 1);
    std::vector<Ray> batch(kChunk);
    for (Ray& ray : batch) {
      ray.time = random.uniform();
      // The chords of a track cut inside the true motion; half the radius stays well within.
      const Vec3d inside = motion(Vec3d(random.direction() * (0.5f * random.uniform())), double(ray.time));
      ray.org = Vec3f(inside + offset);
      ray.dir = random.direction();
    }
    std::vector<Hit> hits(kChunk);  // alternately one by one and all at once
    if (chunk % 2 == 0) {
      tracer.intersect(batch, hits.data());
    } else {
      for (std::size_t i = 0; i < kChunk; ++i) tracer.intersect(batch[i], hits[i]);
    }
    misses +=
        static_cast<std::uint64_t>(std::ranges::count_if(hits, [](const Hit& h) { return !h.found(); }));
  });
  return misses;
}

void check_no_leaks(const TrackForm& form, double position, std::uint64_t rays) {
  const Vec3d offset{position, position, -position};
  const Motion motion = [](const Vec3d& p, double u) {
    return rotation({1, 2, 0.5}, 2.0)(p, u) + Vec3d{40.0, -25.0, 10.0} * (u - 0.5);
  };
  const Accel accel = accel_of({moved(sphere(48), form, motion, offset)});
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(form.segments);
    CAPTURE(form.degree);
    CAPTURE(position);
    CAPTURE(instruction_set_name(set));
    CHECK(count_misses(accel, set, motion, offset, rays) == 0);
  }
}

}  // namespace

TEST_CASE("a closed moving mesh does not leak") {
  for (const std::uint32_t segments : {1u, 8u, 128u}) {
    for (const double position : {0.0, 1e3, 1e4}) check_no_leaks({segments, 1}, position, 60'000);
  }
}

TEST_CASE("nor does one on curves") {
  for (const std::uint32_t degree : {2u, 3u}) {
    for (const std::uint32_t segments : {1u, 4u, 32u}) {
      for (const double position : {0.0, 1e4}) check_no_leaks({segments, degree}, position, 60'000);
    }
  }
}

TEST_SUITE("slow") {
  TEST_CASE("129 keys at position 1e4: no leak in ten million rays") {
    check_no_leaks({128, 1}, 1e4, 10'000'000);
  }
  TEST_CASE("two cubics at position 1e4: no leak in ten million rays") {
    check_no_leaks({2, 3}, 1e4, 10'000'000);
  }
}
