// verify()'s part for grids (core/bvh/verify.h): patches lie in their leaves' boxes, points in their tiles'.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/base/box.h"
#include "core/bvh/bvh.h"
#include "core/motion/bezier.h"

namespace msbvh {

// A track of boxes; in the time of its slice, where that is not the whole shutter.
struct Slot {
  TrackForm form;
  std::vector<Box3f> controls;
  TimeSlice slice = {};

  Box3f at(float u) const {
    const SegmentTime t =
        slice.whole() || !form.moving() ? locate(u, form.segments) : SegmentTime{0, slice.share(u)};
    return track_value(controls.data(), form, t.key, t.w);
  }
};

class GridVerifier {
 public:
  explicit GridVerifier(const Bvh& bvh) : bvh_(bvh) {}

  // Of a tree for this slice of the shutter.
  void begin(const TimeSlice& slice);
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

  const Bvh& bvh_;
  TimeSlice slice_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Leaf>> leaves_;  // by mesh and patch
};

}  // namespace msbvh
