// The binary topology: what its leaves hold, its budget, degenerate sets, determinism, cancelling.
#include <algorithm>
#include <array>
#include <atomic>
#include <doctest/doctest.h>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "bench/procedural.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/build/make_references.h"
#include "core/build/motion_split.h"
#include "core/build/spatial_split.h"
#include "core/build/topology.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

TriangleMesh flat(std::uint32_t vertices, std::vector<Vec3f> positions, std::vector<Triangle> triangles) {
  TriangleMesh mesh;
  mesh.name = "flat";
  mesh.vertex_count = vertices;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  return mesh;
}

TriangleMesh copies(std::size_t count, std::vector<Vec3f> corners) {
  return flat(3, std::move(corners), std::vector<Triangle>(count, Triangle{0, 1, 2}));
}

struct Built {
  std::shared_ptr<const TriangleMesh> mesh;
  Topology topology;
};

Built built(TriangleMesh mesh, const BuildSettings& settings = {}) {
  Built b{std::make_shared<const TriangleMesh>(validated(std::move(mesh))), {}};
  b.topology = build_topology({{&b.mesh, 1}, {}}, settings);
  return b;
}

std::uint64_t budget(std::size_t triangles) {
  return triangles + static_cast<std::uint64_t>(BuildSettings{}.spatial_split_budget * float(triangles));
}

// Every triangle is in a leaf, leaves are no larger than allowed, parents contain children and leaves their
// references, the budget holds.
void check(const Built& b, std::size_t max_leaf = BuildSettings{}.max_leaf_triangles) {
  const Topology& t = b.topology;
  std::vector<bool> seen(b.mesh->triangles.size());
  std::uint64_t references = 0, faults = 0;
  std::vector<std::uint32_t> stack{0};
  const auto inside = [&](const float* lo, const float* hi, const BinaryNode& node) {
    for (int axis = 0; axis < 3; ++axis) faults += lo[axis] < node.lo[axis] || hi[axis] > node.hi[axis];
  };
  while (!stack.empty()) {
    const BinaryNode& node = t.nodes[stack.back()];
    stack.pop_back();
    faults += node.is_leaf() && node.count > max_leaf;
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const Reference& r = t.references[node.first + i];
      seen[r.index] = true;
      inside(&r.box.lo.x, &r.box.hi.x, node);
    }
    references += node.count;
    if (node.is_leaf()) continue;
    for (const std::uint32_t child : {node.first, node.first + 1}) {
      REQUIRE(child < t.node_count);
      inside(t.nodes[child].lo, t.nodes[child].hi, node);
      stack.push_back(child);
    }
  }
  CHECK(faults == 0);
  CHECK(std::count(seen.begin(), seen.end(), false) == 0);
  CHECK(references == t.reference_count);
  CHECK(references <= budget(seen.size()));
}

// What a tree is, whatever its nodes are numbered: boxes, sizes and triangles in depth-first order.
std::vector<std::tuple<float, std::uint32_t, std::uint64_t>> signature(const Topology& t) {
  std::vector<std::tuple<float, std::uint32_t, std::uint64_t>> out;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const BinaryNode& node = t.nodes[stack.back()];
    stack.pop_back();
    std::uint64_t ids = 0;
    for (std::uint32_t i = 0; i < node.count; ++i) ids += t.references[node.first + i].index;
    out.emplace_back(node.area, node.count, ids);
    if (!node.is_leaf()) stack.insert(stack.end(), {node.first, node.first + 1});
  }
  return out;
}

}  // namespace

TEST_CASE("topology: nothing, and one triangle") {
  CHECK(built(copies(0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})).topology.node_count == 0);
  const Built one = built(copies(1, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  CHECK(one.topology.nodes[0].count == 1);
  check(one);
}

TEST_CASE("topology: degenerate sets end, within the budget") {
  check(built(copies(50'000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})));            // identical
  check(built(copies(50'000, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}})));            // without area
  check(built(copies(50'000, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}})));            // points
  check(built(copies(50'000, {{0, 0, 0}, {1e-42f, 0, 0}, {0, 1e-42f, 0}})));  // denormal
  check(built(grid(120)));                                                    // in one plane
  check(built(moved(copies(50'000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 1, translation({5, 0, 0}))));
}

TEST_CASE("topology: a million triangles in one place") {
  check(built(copies(1'000'000, {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}})));
}

TEST_CASE("topology: sets that are cut, and sets that part") {
  check(built(sticks(3000, 3)));
  check(built(debris(20'000, 1, 2.0f, 4)));
  check(built(debris(5'000, 8, 2.0f, 4)));
  BuildSettings centre;
  centre.sah_time = SahTime::kCentre;
  check(built(debris(20'000, 1, 2.0f, 4), centre));
  BuildSettings large;
  large.max_leaf_triangles = 3000;
  check(built(soup(10'000, 0.1f, 4), large), 3000);
}

TEST_CASE("topology: no budget, a small one, none of it exceeded") {
  for (const float share : {0.0f, 0.01f, 0.3f}) {
    BuildSettings settings;
    settings.spatial_split_budget = share;
    const Built b = built(sticks(3000, 5), settings);
    check(b);
    const auto triangles = b.mesh->triangles.size();
    CHECK(b.topology.reference_count <=
          triangles + static_cast<std::uint64_t>(share * static_cast<float>(triangles)));
  }
}

TEST_CASE("topology: the same on any number of threads") {
  const auto on = [](unsigned threads, const TriangleMesh& mesh) {
    Built b;
    Arena(threads).execute([&] { b = built(mesh); });
    return signature(b.topology);
  };
  for (const TriangleMesh& mesh : {sticks(20'000, 3), debris(100'000, 1, 1.0f, 4), soup(100'000, 0.02f, 5)})
    CHECK(on(1, mesh) == on(2, mesh));
}

TEST_CASE("topology: cancelled at any time, it throws and the next build is whole") {
  for (const TriangleMesh& mesh : {sticks(8'000, 3), debris(50'000, 1, 1.0f, 4)}) {
    for (const int after : {0, 1, 3}) {
      std::atomic<int> asked = 0;
      BuildSettings settings;
      settings.cancelled = [&] { return asked++ >= after; };
      CHECK_THROWS_AS(built(mesh, settings), Cancelled);
    }
    check(built(mesh));
  }
}

TEST_CASE("nodes stay within their array where every leaf holds one reference") {
  for (const std::size_t count : {1000u, 1031u, 5000u}) {
    BuildSettings settings;
    settings.builder = Builder::kMbvh;
    settings.max_leaf_triangles = 1;
    const Built b = built(soup(static_cast<std::uint32_t>(count), 0.2f, 3), settings);
    check(b, 1);
    CHECK(b.topology.node_count <= 2 * b.topology.reference_count);
  }
}

// Stich et al. 2009, section 4.4: a hair beyond the plane is not worth a second reference, half of it is.
TEST_CASE("spatial splits leave whole what costs less whole") {
  TriangleMesh mesh;
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  mesh.vertex_count = 6;
  mesh.positions = {{-0.5f, -0.5f, 0}, {0.001f, 0, 0}, {-0.5f, 0.5f, 0}, {-1, -1, 0}, {1, 0, 0}, {-1, 1, 0}};
  const std::vector<std::shared_ptr<const TriangleMesh>> meshes = {
      std::make_shared<const TriangleMesh>(validated(std::move(mesh)))};
  const Primitives primitives{.meshes = meshes, .instances = {}};
  const CentrePose pose(primitives);
  const AllReferences all = make_references(pose);
  SpatialSplit split;
  split.plane = 0.0f;
  split.left_count = split.right_count = 10;
  split.left = {{-1, -1, -1}, {0, 1, 1}};
  split.right = {{0, -1, -1}, {1, 1, 1}};
  std::array<Reference, 4> room{(*all.memory)[0], (*all.memory)[1]};
  CHECK(cut_references(pose, {room.data(), 2}, 2, split) == 1);
  CHECK_FALSE(room[0].is_clipped());
  CHECK(room[1].is_clipped());
  CHECK(room[1].box.hi.x == 0.0f);
  CHECK(room[2].is_clipped());
  CHECK(room[2].box.lo.x == 0.0f);
}

namespace {

// A quad that flies along x over the shutter, through the origin at its centre.
TriangleMesh flying(float side, float way) {
  const std::vector<Vec3f> quad{{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
  std::vector<Vec3f> positions;
  for (const float x : {-0.5f * way, 0.5f * way}) {
    for (const Vec3f& p : quad) positions.push_back(p + Vec3f{x, 0.0f, 0.0f});
  }
  TriangleMesh mesh = flat(4, std::move(positions), {{0, 1, 2}, {0, 2, 3}});
  mesh.segments = 1;
  return mesh;
}

// Whether the root's left child holds all that stands still, and nothing else.
bool is_parted(TriangleMesh still, TriangleMesh moving, const BuildSettings& settings = {}) {
  const std::vector<std::shared_ptr<const TriangleMesh>> meshes{
      std::make_shared<const TriangleMesh>(validated(std::move(still))),
      std::make_shared<const TriangleMesh>(validated(std::move(moving)))};
  const Topology topology = build_topology({meshes, {}}, settings);
  std::set<std::uint32_t> found;
  std::vector<std::uint32_t> pending{topology.root().first};
  while (!pending.empty()) {
    const BinaryNode& node = topology.nodes[pending.back()];
    pending.pop_back();
    if (!node.is_leaf()) {
      pending.insert(pending.end(), {node.first, node.first + 1});
      continue;
    }
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const Reference& reference = topology.references[node.first + i];
      if (reference.mesh() != 0) return false;
      found.insert(reference.index);
    }
  }
  return found.size() == meshes[0]->triangles.size();
}

}  // namespace

TEST_CASE("topology: what moves in a corner is parted from the rest at the root") {
  CHECK(is_parted(sphere(12), flying(0.1f, 0.3f)));
  BuildSettings paper;
  paper.sah_time = SahTime::kCentre;
  CHECK(!is_parted(sphere(12), flying(0.1f, 0.3f), paper));
}

TEST_CASE("topology: a corner is small, and little is in it") {
  const auto corner = [](TriangleMesh still, TriangleMesh moving) {
    const std::vector<std::shared_ptr<const TriangleMesh>> meshes{
        std::make_shared<const TriangleMesh>(validated(std::move(still))),
        std::make_shared<const TriangleMesh>(validated(std::move(moving)))};
    const Primitives primitives{meshes, {}};
    const CentrePose pose(primitives);
    const AllReferences all = make_references(pose);
    return moves_in_a_corner(primitives, {all.memory->data(), all.count});
  };
  CHECK(corner(sphere(12), flying(0.1f, 0.3f)));
  CHECK(!corner(sphere(12), flying(1.0f, 20.0f)));  // all over the scene
  CHECK(!corner(flat(3, {{0, 0, 0}, {9, 0, 0}, {0, 9, 9}}, {{0, 1, 2}}), flying(0.1f, 0.3f)));  // most of it
  CHECK(!corner(sphere(12), sphere(3)));  // nothing moves
}
