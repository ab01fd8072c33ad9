// verify()'s part for grids (core/bvh/verify.h): patches lie in their leaves' boxes, points in their tiles'.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "core/base/box.h"
#include "core/bvh/bvh.h"
#include "core/bvh/verify_slot.h"

namespace msbvh {

class GridVerifier {
 public:
  explicit GridVerifier(const Bvh& bvh, const TimeSlice& slice = {}) : bvh_(bvh), slice_(slice) {}

  // A leaf's block, and what the tree says that bounds it. Checks what the block says of itself.
  void add(const BlockHeader& block, const Slot& slot);
  // After all leaves: each patch is in some, and each of its triangles, moved as its vertices are, lies in
  // the boxes of those leaves whose windows hold it.
  void finish() const;

 private:
  struct Leaf {
    GridPatch window;
    Slot slot;
  };
  void check_tiles(const GridMesh& mesh, const BlockHeader& block, const GridPatch& window) const;
  void check_triangle(const GridMesh& mesh, std::uint32_t id, const std::vector<Leaf>& leaves) const;

  std::reference_wrapper<const Bvh> bvh_;
  TimeSlice slice_;  // of the tree that is looked at
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Leaf>> leaves_;  // by mesh and patch
};

}  // namespace msbvh
