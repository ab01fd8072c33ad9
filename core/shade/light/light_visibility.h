// How much of what the lights of a tree send is seen, region by region: learnt from some shadow rays before a
// frame is drawn. It tells the tree which lights stand behind walls; it changes no more than the noise.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/box.h"
#include "core/shade/light/light_tree.h"

namespace msbvh {

// What one shadow ray has found.
struct SeenLight {
  Vec3f point;
  std::uint32_t light = 0;  // number in the tree
  bool tried = false;       // false: there was no ray
  bool seen = false;
};

class LightVisibility {
 public:
  LightVisibility() = default;
  // The same for any order of the threads that have filled `rays`, whose own order counts.
  LightVisibility(const Box3f& bounds, const LightTree& tree, const std::vector<SeenLight>& rays);

  // By node of the tree, in 255ths; null where nothing is known.
  const std::uint8_t* at(const Vec3f& point) const {
    if (row_of_cell_.empty()) return nullptr;
    const std::uint32_t row = row_of_cell_[cell_of(point)];
    return row == kNoRow ? nullptr : shares_.data() + std::size_t(row) * nodes_;
  }

 private:
  static constexpr std::uint32_t kNoRow = 0xffffffffu;

  std::size_t cell_of(const Vec3f& point) const;
  std::vector<std::uint8_t> shares_of(const LightTree& tree, const std::vector<const SeenLight*>& rays) const;

  Box3f bounds_;
  std::array<std::uint32_t, 3> cells_{};
  Vec3f cells_a_unit_;
  std::size_t nodes_ = 0;
  std::vector<std::uint32_t> row_of_cell_;
  std::vector<std::uint8_t> shares_;  // [row][node]
};

}  // namespace msbvh
