// A build that is cancelled, at whatever moment, leaves nothing behind: not a byte, and an Accel that builds
// the very tree that it would have built.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <doctest/doctest.h>
#include <memory>
#include <string>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "tests/memory/counting_allocator.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

constexpr int kMoments = 6;

using Mesh = std::shared_ptr<const TriangleMesh>;

struct Settings : BuildSettings {
  std::shared_ptr<std::atomic<int>> asked = std::make_shared<std::atomic<int>>(0);

  // Goes on until it has been asked so many times.
  Settings(Builder builder_, int moments) {
    builder = builder_;
    keep_topology = true;
    cancelled = [count = asked.get(), moments] { return (*count)++ >= moments; };
  }
};

void expect_same(const Accel& a, const Accel& b) {
  REQUIRE(a.bvh().arena.size() == b.bvh().arena.size());
  CHECK(std::memcmp(a.bvh().arena.data(), b.bvh().arena.data(), a.bvh().arena.size()) == 0);
}

// Whether it was cancelled.
bool cancel_once(Accel& accel, const Settings& settings) {
  try {
    accel.commit(settings);
    return false;
  } catch (const Cancelled&) {
    return true;
  }
}

void check(const Mesh& mesh, Builder builder) {
  const Settings whole(builder, 1 << 30);
  Accel reference;
  reference.add_mesh(mesh);
  reference.commit(whole);
  const int moments = *whole.asked;
  REQUIRE(moments > 0);
  Accel accel;
  accel.add_mesh(mesh);
  for (int i = 0; i <= kMoments; ++i) {
    const Settings settings(builder, i * (moments - 1) / kMoments);
    const std::int64_t bytes = memory::held_bytes(), blocks = memory::held_blocks();
    const bool stopped = cancel_once(accel, settings);
    CHECK(stopped);
    if (!stopped) return;
    CHECK(memory::held_bytes() == bytes);
    CHECK(memory::held_blocks() == blocks);
    CHECK_THROWS(accel.bvh());
  }
  const Settings settings(builder, 1 << 30);
  accel.commit(settings);
  expect_same(accel, reference);
}

}  // namespace

TEST_CASE("cancelled at any moment, by any builder, at any key count") {
  for (const unsigned threads : {1u, 2u}) {
    Arena(threads).execute([threads] {
      for (const std::uint32_t segments : {0u, 1u, 8u, 128u}) {
        const auto part = [&](TriangleMesh m) {
          return std::make_shared<const TriangleMesh>(
              validated(moved(std::move(m), segments, rotation({0, 1, 0}, 0.5))));
        };
        const Mesh sticks_mesh = part(sticks(segments == 128 ? 400 : 2'000, 3));
        for (const BuilderName& builder : kBuilders) {
          CAPTURE(threads);
          CAPTURE(segments);
          CAPTURE(std::string(builder.name));
          check(sticks_mesh, builder.builder);
        }
      }
      check(std::make_shared<const TriangleMesh>(validated(debris(30'000, 1, 2.0f, 4))), Builder::kMsbvh);
    });
  }
}

TEST_CASE("a refit that is cancelled leaves the frame before as it was, its topology as well") {
  const auto frame = [](std::uint32_t segments) {
    return std::make_shared<const TriangleMesh>(
        validated(moved(sticks(3'000, 3), segments, rotation({0, 1, 0}, 0.5))));
  };
  const Mesh first = frame(2), second = frame(4);
  const Settings whole(Builder::kMsbvh, 1 << 30);
  Accel previous, next;
  previous.add_mesh(first);
  previous.commit(whole);
  next.add_mesh(second);
  for (int moment = 0; moment < 8; ++moment) {
    const Settings settings(Builder::kMsbvh, moment);
    const std::int64_t bytes = memory::held_bytes(), blocks = memory::held_blocks();
    CHECK_THROWS_AS(next.commit_from(previous, settings), Cancelled);
    CHECK(memory::held_bytes() == bytes);
    CHECK(memory::held_blocks() == blocks);
  }
  next.commit_from(previous, whole);
  CHECK(next.statistics().refitted == 1);
  CHECK_NOTHROW(next.verify());
  CHECK_NOTHROW(previous.verify());
}
