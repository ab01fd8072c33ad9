// What a tree does not hold costs nothing: kernels that know of grids, curves and points are for trees that
// hold some, and in a tree of triangles alone they visit the same nodes and give the same bits.
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "core/bvh/build_bvh.h"
#include "core/bvh/leaf_kinds.h"
#include "tests/property/support.h"

using namespace msbvh;
using msbvh::procedural::Random;

namespace {

constexpr std::size_t kRays = 4096;
constexpr LeafKinds kAll = {LeafKind::kTriangles, LeafKind::kInstances, LeafKind::kGrids, LeafKind::kCurves,
                            LeafKind::kPoints};

Bvh triangles_alone(const TrackForm& form) {
  BvhInput input;
  TriangleMesh mesh =
      procedural::moved(procedural::soup(3000, 0.2f, 3), form, procedural::rotation({0.0, 1.0, 0.0}, 0.4));
  input.meshes.push_back(std::make_shared<const TriangleMesh>(validated(std::move(mesh))));
  return build_bvh(std::move(input), {}).bvh;
}

// Half of them like a camera's, which go down the tree as packets; at times in no order.
std::vector<Ray> rays() {
  Random random(11);
  std::vector<Ray> all;
  for (std::size_t i = 0; i < kRays; ++i) all.push_back(procedural::random_ray(random, {}, 1.5f));
  for (std::size_t i = 0; i < kRays / 2; ++i) {
    const auto x = static_cast<float>(i % 64) / 64.0f - 0.5f, y = static_cast<float>(i / 64) / 32.0f - 0.5f;
    all[i].org = {0.0f, 0.0f, 5.0f};
    all[i].dir = {0.5f * x, 0.5f * y, -1.0f};
  }
  return all;
}

struct Answers {
  std::vector<Hit> hits = std::vector<Hit>(kRays), many = hits;
  std::vector<std::uint8_t> shadowed = std::vector<std::uint8_t>(kRays);
  TraceCounts counts;
};

Answers traced(const Bvh& bvh, InstructionSet set) {
  const Tracer tracer(bvh, set);
  const std::vector<Ray> all = rays();
  Answers answers;
  for (std::size_t i = 0; i < kRays; ++i) {
    Hit counted;
    const bool found = tracer.intersect(all[i], answers.hits[i]);
    CHECK(tracer.intersect_counted(all[i], counted, answers.counts) == found);
    answers.shadowed[i] = tracer.occluded(all[i]);
  }
  tracer.intersect(all, answers.many.data());
  return answers;
}

bool same_bits(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  for (std::size_t i = 0; i < kRays; ++i) {
    if (a[i].found() != b[i].found()) return false;
    if (a[i].found() && (std::memcmp(&a[i].t, &b[i].t, sizeof(float)) != 0 || a[i].u != b[i].u ||
                         a[i].v != b[i].v || a[i].triangle != b[i].triangle))
      return false;
  }
  return true;
}

}  // namespace

TEST_CASE("a tree of triangles alone has the kernels for triangles alone") {
  CHECK(triangles_alone({1, 1}).leaf_kinds == kTrianglesAlone);
  CHECK(kernel_set_for(kTrianglesAlone) == 0);
  CHECK(kernel_set_for(kAll) != 0);
}

TEST_CASE("kernels for leaves of all kinds give triangles the same bits by the same visits") {
  for (const TrackForm& form : {TrackForm{0, 1}, TrackForm{1, 1}, TrackForm{8, 1}, TrackForm{2, 3}}) {
    Bvh bvh = triangles_alone(form);
    for (const InstructionSet set : supported_instruction_sets()) {
      CAPTURE(form.segments);
      CAPTURE(instruction_set_name(set));
      bvh.leaf_kinds = kTrianglesAlone;
      const Answers alone = traced(bvh, set);
      bvh.leaf_kinds = kAll;
      const Answers forced = traced(bvh, set);
      CHECK(same_bits(alone.hits, forced.hits));
      CHECK(same_bits(alone.hits, alone.many));
      CHECK(same_bits(alone.many, forced.many));
      CHECK(alone.shadowed == forced.shadowed);
      CHECK(alone.counts.nodes == forced.counts.nodes);
      CHECK(alone.counts.triangles == forced.counts.triangles);
      CHECK(alone.counts.triangles > kRays);
    }
  }
}
