// What moves costs where it is, and nowhere else: counted in nodes, not timed.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

struct NodeCounts {
  std::uint64_t still = 0, moving = 0;
  std::uint64_t needless = 0;                           // have several keys, and nothing below them moves
  std::uint64_t instance_leaves = 0, below_moving = 0;  // and those of them whose parent moves
};

// Walks the nodes of one tree; returns whether anything below `ref` moves. Instances count by their own maps
// and by what they show.
bool count_nodes(const Bvh& bvh, ChildRef ref, NodeCounts& counts) {
  if (ref.is_leaf()) {
    const BlockHeader* block = &bvh.block(ref);
    for (;; block = next_block(block)) {
      if (block->kind == BlockKind::kInstance) {
        const Instance& instance = bvh.instances[block->owner];
        if (instance.form.moving() || instance.object->movement != Movement::kStill) return true;
        return false;
      }
      if (block->form_code.form().moving()) return true;
      if (block->last) return false;
    }
  }
  const NodeHeader& node = bvh.node(ref);
  bool moves = false;
  for (std::uint32_t i = 0; i < node.child_count; ++i) {
    const ChildRef child = node.child[i];
    moves |= count_nodes(bvh, child, counts);
    if (!child.is_leaf() || bvh.block(child).kind != BlockKind::kInstance) continue;
    ++counts.instance_leaves;
    counts.below_moving += node.form().moving();
  }
  ++(node.form().moving() ? counts.moving : counts.still);
  if (node.form().moving() && !moves) ++counts.needless;
  return moves;
}

NodeCounts counted(const Accel& accel) {
  NodeCounts counts;
  count_nodes(accel.bvh(), accel.bvh().root, counts);
  return counts;
}

// Ten thousand still squares on a plane, as instances of one object, and a sphere that deforms on 8 segments.
constexpr int kSide = 100;

TriangleMesh hero() { return moved(sphere(24), 8, rotation({0, 1, 0}, 1.0), {50.0, 0.0, 50.0}); }

Accel crowd(bool with_hero) {
  auto object = std::make_shared<Accel>();
  object->add_mesh(moved(sphere(4), 0, translation({0, 0, 0}), {}));
  object->commit();
  std::vector<Affine3f> places;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec3f at{static_cast<float>(i % kSide), 0.0f, static_cast<float>(i / kSide)};
    places.push_back({{0.3f, 0, 0}, {0, 0.3f, 0}, {0, 0, 0.3f}, at});
  }
  Accel accel;
  if (with_hero) accel.add_mesh(hero());
  accel.add_instances(std::move(object), {}, places);
  accel.commit();
  return accel;
}

}  // namespace

TEST_CASE("one deforming hero among ten thousand still instances leaves their nodes still") {
  Accel alone;
  alone.add_mesh(hero());
  alone.commit();
  const NodeCounts of_hero = counted(alone), without = counted(crowd(false));
  const Accel accel = crowd(true);
  const NodeCounts with = counted(accel);
  MESSAGE("moving nodes ", with.moving, ", of the hero alone ", of_hero.moving, "; instances ",
          with.instance_leaves, ", below moving nodes ", with.below_moving);
  CHECK_NOTHROW(accel.verify());
  CHECK(without.moving == 0);
  CHECK(of_hero.still == 0);
  CHECK(with.needless == 0);
  // The hero's own, and those on the ways to it from the root.
  CHECK(with.moving <= of_hero.moving + of_hero.moving / 2 + accel.statistics().depth);
  CHECK(with.instance_leaves >= kSide * kSide);
  CHECK(100 * with.below_moving < with.instance_leaves);
}

TEST_CASE("rays that pass a spinning prop by cost as they would without it") {
  const auto room = [] { return moved(soup(20000, 0.05f, 5), 0, translation({0, 0, 0}), {}); };
  Accel set, with_prop;
  set.add_mesh(room());
  set.commit();
  with_prop.add_mesh(room());
  with_prop.add_mesh(moved(sphere(24), 32, rotation({0, 1, 0}, 3.0), {6.0, 0.0, 0.0}));
  with_prop.commit();
  CHECK(counted(with_prop).needless == 0);

  TraceCounts plain, beside;
  Random random(3);
  constexpr float kBeforeProp = 4.5f;  // the prop reaches from x = 5 to 7, and turns in place
  int same = 0, rays = 0;
  for (int i = 0; i < 4000; ++i) {
    Ray ray = random_ray(random, {}, 2.0f);
    if (ray.org.x >= kBeforeProp) continue;
    if (ray.dir.x > 0.0f) ray.tfar = std::min(ray.tfar, (kBeforeProp - ray.org.x) / ray.dir.x);
    ++rays;
    Hit a, b;
    const bool hit = Tracer(set.bvh()).intersect_counted(ray, a, plain);
    const bool hit_beside = Tracer(with_prop.bvh()).intersect_counted(ray, b, beside);
    same += hit == hit_beside && (!hit || a.t == b.t);
  }
  MESSAGE("nodes ", beside.nodes, " against ", plain.nodes, ", triangles ", beside.triangles, " against ",
          plain.triangles);
  CHECK(rays > 3000);
  CHECK(same == rays);
  CHECK(beside.nodes <=
        plain.nodes + std::uint64_t(rays));  // the root, where the prop is parted from the set
  CHECK(beside.triangles <= plain.triangles + plain.triangles / 50);
}
