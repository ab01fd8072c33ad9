// Object splits: a binned SAH over the centres of the references' boxes at the shutter's centre.
// I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", RT 2007.
#pragma once

#include <limits>
#include <span>

#include "core/build/reference.h"

namespace msbvh {

inline constexpr std::size_t kTrianglesPerBlock = 8;

// Leaves are tested in blocks of 8 triangles, so cost is counted in blocks.
constexpr float block_count(std::size_t references) {
  return static_cast<float>((references + kTrianglesPerBlock - 1) / kTrianglesPerBlock);
}

// Boxes of a set of references: of the references, and of their boxes' centres.
struct SetBounds {
  Box3f box;
  Box3f centres;
};
SetBounds bounds_of(std::span<const Reference> references);

// Which of kObjectBins equal bins a reference falls in along an axis, by its box's centre.
struct ObjectBinning {
  static constexpr int kBins = 32;
  Vec3f lo, scale;

  explicit ObjectBinning(const Box3f& centres);
  int bin(const Box3f& box, int axis) const {
    const float x = (box.lo[axis] * 0.5f + box.hi[axis] * 0.5f - lo[axis]) * scale[axis];
    return std::clamp(static_cast<int>(x), 0, kBins - 1);
  }
};

// References whose bin along `axis` is below `first_right_bin` go left. `cost` is the area-weighted number of
// blocks, infinite if there is no split that leaves something on both sides.
struct ObjectSplit {
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0;
  int first_right_bin = 0;
  Box3f left, right;
};

ObjectSplit find_object_split(std::span<const Reference> references, const ObjectBinning& binning);

}  // namespace msbvh
