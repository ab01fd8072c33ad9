// Rays meet a compact node as they meet the full node of its decoded boxes: same children, same distances, on
// every instruction set that this machine has.
#include <doctest/doctest.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/test_compact_node_test.cpp"
#include <array>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <random>

#include "core/trace/node_test-inl.h"

#ifndef MSBVH_TEST_COMPACT_NODE_TEST
#define MSBVH_TEST_COMPACT_NODE_TEST
namespace msbvh {

// A node with room for its boxes.
struct TestNode {
  NodeHeader header{};
  std::array<NodeBounds, 9> boxes;
};
static_assert(offsetof(TestNode, boxes) == sizeof(NodeHeader));

struct TestNodes {
  TestNode compact, full;
};

// 2 to 8 children, some of them flat; absent ones lie where no ray is let in by mistake.
inline TestNodes random_nodes(std::mt19937_64& random, const TrackForm& form) {
  std::uniform_real_distribution<float> at(-1.0f, 1.0f);
  TestNodes nodes;
  const auto count = static_cast<std::uint8_t>(2 + random() % 7);
  std::vector<Box3f> boxes(std::size_t(count) * form.controls());
  for (Box3f& box : boxes) {
    Vec3f lo{at(random), at(random), at(random)}, hi{at(random), at(random), at(random)};
    if (random() % 4 == 0) hi.y = lo.y;
    box.grow(lo);
    box.grow(hi);
  }
  for (TestNode* node : {&nodes.compact, &nodes.full}) {
    node->header.child_count = count;
    node->header.form_code = FormCode::of(form);
    node->header.compact = node == &nodes.compact;
  }
  nodes.compact.header.frame = frame_around(boxes);
  constexpr Box3f kNothing{{kAbsent, kAbsent, kAbsent}, {-kAbsent, -kAbsent, -kAbsent}};
  for (std::uint32_t c = 0; c < form.controls(); ++c) {
    CompactBounds& out = nodes.compact.header.compact_bounds()[c];
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      if (i < count) {
        out.set_box(nodes.compact.header.frame, i, boxes[std::size_t(i) * form.controls() + c]);
        nodes.full.header.bounds()[c].set_box(i, nodes.compact.header.box(c, i));
      } else {
        out.set_absent(i);
        nodes.full.header.bounds()[c].set_box(i, kNothing);
      }
    }
  }
  return nodes;
}

inline Ray random_ray_at(std::mt19937_64& random) {
  std::uniform_real_distribution<float> at(-1.0f, 1.0f), time(0.0f, 1.0f);
  // From afar what is inside out is thinner than the test's factor: absent boxes must not be met either.
  constexpr float kAway[] = {2.0f, 2.0f, 1e4f, 3e7f};
  const float away = kAway[random() % 4];
  Ray ray;
  ray.dir = {at(random), at(random), random() % 8 == 0 ? 0.0f : at(random)};
  ray.org = Vec3f{at(random), at(random), at(random)} - ray.dir * away;
  ray.time = time(random);
  return ray;
}

}  // namespace msbvh
#endif

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

template <Movement kMovement>
void check_alike(const TrackForm& form) {
  std::mt19937_64 random(5);
  Bvh bvh;
  bvh.max_level = level_of(form.segments);
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const TestNodes nodes = random_nodes(random, form);
    const RaySetup<kMovement> setup(random_ray_at(random), bvh);
    std::uint32_t hits[2];
    alignas(64) ChildKey keys[2][kWidth];
    const FormCode code = FormCode::of(form);
    test_node<kMovement, true>(nodes.compact.header, code, setup, 1e30f, hits[0]).store(keys[0]);
    test_node<kMovement, false>(nodes.full.header, code, setup, 1e30f, hits[1]).store(keys[1]);
    REQUIRE(hits[0] == hits[1]);
    for (std::uint32_t c = 0; c < kWidth; ++c) REQUIRE(keys[0][c] == keys[1][c]);
    met += hits[0] != 0;
  }
  CHECK(met > 1000);
}

void check_all() {
  check_alike<Movement::kStill>({});
  check_alike<Movement::kLinear>({1, 1});
  check_alike<Movement::kLinear>({8, 1});
  check_alike<Movement::kPolynomial>({1, 2});
  check_alike<Movement::kPolynomial>({2, 3});
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace msbvh {

TEST_CASE("compact nodes are met as full ones of their decoded boxes") {
  const std::int64_t supported = hwy::SupportedTargets();
#if HWY_TARGETS & HWY_SSE4
  if ((supported & HWY_SSE4) != 0) N_SSE4::check_all();
#endif
#if HWY_TARGETS & HWY_AVX2
  if ((supported & HWY_AVX2) != 0) N_AVX2::check_all();
#endif
#if HWY_TARGETS & HWY_AVX3
  if ((supported & HWY_AVX3) != 0) N_AVX3::check_all();
#endif
}

}  // namespace msbvh
#endif
