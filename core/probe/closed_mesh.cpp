#include "core/probe/closed_mesh.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

namespace msbvh {
namespace {

// For each vertex, one that lies where it does at every control.
std::vector<std::uint32_t> welded(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertex_count), first(mesh.vertex_count);
  std::iota(order.begin(), order.end(), 0u);
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) {
      const Vec3f &p = mesh.control_positions(c)[a], &q = mesh.control_positions(c)[b];
      for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] != q[axis]) return p[axis] < q[axis] ? -1 : 1;
      }
    }
    return 0;
  };
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return compare(a, b) < 0; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && compare(order[i - 1], order[i]) == 0;
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace

bool is_closed(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> place = welded(mesh);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> there, back;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = place[t[k]], b = place[t[(k + 1) % 3]];
      if (a == b) continue;
      there.emplace_back(a, b);
      back.emplace_back(b, a);
    }
  }
  std::ranges::sort(there);
  std::ranges::sort(back);
  return !there.empty() && there == back;
}

std::vector<const ShownMesh*> closed_meshes(const ShownMeshes& all) {
  std::unordered_map<const TriangleMesh*, bool> known;
  std::vector<const ShownMesh*> closed;
  for (const ShownMesh& shown : all.meshes()) {
    const auto [at, is_new] = known.try_emplace(shown.mesh, false);
    if (is_new) at->second = is_closed(*shown.mesh);
    if (at->second) closed.push_back(&shown);
  }
  return closed;
}

}  // namespace msbvh
