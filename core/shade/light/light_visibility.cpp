#include "core/shade/light/light_visibility.h"

#include <algorithm>
#include <cmath>

namespace msbvh {
namespace {

constexpr std::uint32_t kMostCells = 16;        // along an axis
constexpr double kMostBytes = double(1 << 24);  // of all shares, about
constexpr double kSurfaceRows = 6.0;            // rows, by cells of a side: those of a cube's surface
// A node counts as if so many more rays had found its parent's share, and the root as if they had seen all.
constexpr double kPrior = 1.0;
// The least that a byte holds, of a node that no ray has seen: it may be seen from beside them.
constexpr double kLeastShare = 1.0 / 255.0;

}  // namespace

LightVisibility::LightVisibility(const Box3f& bounds, const LightTree& tree,
                                 const std::vector<SeenLight>& rays)
    : bounds_(bounds), nodes_(tree.node_count()) {
  const Vec3f extent = bounds.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  if (nodes_ == 0 || !(longest > 0.0f) || !std::isfinite(longest)) return;
  const double affordable = std::sqrt(kMostBytes / (kSurfaceRows * double(nodes_)));
  const auto along_longest = std::clamp(std::uint32_t(affordable), 1u, kMostCells);
  const float edge = longest / float(along_longest);
  const auto count = [&](float e) {
    return std::clamp(std::uint32_t(std::ceil(e / edge)), 1u, along_longest);
  };
  cells_ = {count(extent.x), count(extent.y), count(extent.z)};
  cells_a_unit_ = Vec3f{1, 1, 1} * (1.0f / edge);
  row_of_cell_.assign(std::size_t(cells_[0]) * cells_[1] * cells_[2], kNoRow);
  std::vector<std::vector<const SeenLight*>> by_cell(row_of_cell_.size());
  for (const SeenLight& ray : rays) {
    if (ray.tried) by_cell[cell_of(ray.point)].push_back(&ray);
  }
  std::uint32_t row = 0;
  for (std::size_t cell = 0; cell < by_cell.size(); ++cell) {
    if (by_cell[cell].empty()) continue;
    row_of_cell_[cell] = row++;
    const std::vector<std::uint8_t> shares = shares_of(tree, by_cell[cell]);
    shares_.insert(shares_.end(), shares.begin(), shares.end());
  }
}

std::size_t LightVisibility::cell_of(const Vec3f& point) const {
  const auto place = [](float offset, float a_unit, std::uint32_t cells) {
    return std::size_t(std::clamp(offset * a_unit, 0.0f, float(cells - 1)));
  };
  const Vec3f o = point - bounds_.lo;
  return (place(o.z, cells_a_unit_.z, cells_[2]) * cells_[1] + place(o.y, cells_a_unit_.y, cells_[1])) *
             cells_[0] +
         place(o.x, cells_a_unit_.x, cells_[0]);
}

std::vector<std::uint8_t> LightVisibility::shares_of(const LightTree& tree,
                                                     const std::vector<const SeenLight*>& rays) const {
  std::vector<std::uint32_t> tries(nodes_), seen(nodes_);
  for (const SeenLight* ray : rays) {
    tree.for_path(ray->light, [&](std::uint32_t node) {
      ++tries[node];
      seen[node] += ray->seen;
    });
  }
  std::vector<double> share(nodes_, 1.0);
  share[0] = (seen[0] + kPrior) / (tries[0] + kPrior);
  std::vector<std::uint8_t> result(nodes_);
  tree.for_children([&](std::uint32_t parent, std::uint32_t child) {
    share[child] = (seen[child] + kPrior * share[parent]) / (tries[child] + kPrior);
  });
  for (std::size_t i = 0; i < nodes_; ++i)
    result[i] = std::uint8_t(std::ceil(255.0 * std::max(share[i], kLeastShare)));
  return result;
}

}  // namespace msbvh
