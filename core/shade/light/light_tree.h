// Which of many lights with a place to ask for light, by where they are and where they shine.
//
// A. Conty Estevez and C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018,
// without the splitting; importance as in M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 4th
// edition, section 12.6.3.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/box.h"

namespace msbvh {

// Where some lights are, where they shine, and how much: a bound for all of the shutter.
struct LightReach {
  Box3f box;
  Vec3f axis{0.0f, 0.0f, 1.0f};
  // Normals are within the angle of `cos_around` about `axis`; beyond it, light falls as the cosine, and ends
  // at that of `cos_beyond`.
  float cos_around = -1.0f, cos_beyond = 0.0f;
  float power = 0.0f;  // irradiance at normal incidence and distance 1
};

// About how much reaches a point of a surface with the unit `normal`, or with none (0, 0, 0) where light
// counts from either side, as on glass: 0 only where none does, but for rounding.
float importance(const LightReach& reach, const Vec3f& point, const Vec3f& normal);

class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(const std::vector<LightReach>& lights);

  bool empty() const { return nodes_.empty(); }
  float importance(const Vec3f& point, const Vec3f& normal) const;

  struct Found {
    std::uint32_t light;  // number in the list
    float chance;         // that it is taken, above 0
  };
  // `random` in [0, 1].
  // `seen`: null, or by node what share of its lights is seen from there, above 0; in any unit.
  Found pick(float random, const Vec3f& point, const Vec3f& normal, const std::uint8_t* seen = nullptr) const;
  float chance(std::uint32_t light, const Vec3f& point, const Vec3f& normal,
               const std::uint8_t* seen = nullptr) const;

  std::size_t node_count() const { return nodes_.size(); }
  // visit(node) from the root, which is node 0, down to a light.
  template <typename Visit>
  void for_path(std::uint32_t light, const Visit& visit) const {
    for (std::uint32_t index = 0;;) {
      visit(index);
      if (nodes_[index].second == 0) return;
      index = leaf_of_[light] < nodes_[index].second ? index + 1 : nodes_[index].second;
    }
  }
  // visit(parent, child), parents first.
  template <typename Visit>
  void for_children(const Visit& visit) const {
    for (std::uint32_t parent = 0; parent < nodes_.size(); ++parent) {
      if (nodes_[parent].second == 0) continue;
      visit(parent, parent + 1);
      visit(parent, nodes_[parent].second);
    }
  }

 private:
  struct Node {
    LightReach reach;
    std::uint32_t second = 0;  // the first child follows; 0: a leaf
    std::uint32_t light = 0;   // of a leaf
  };

  std::uint32_t build(std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                      const std::vector<LightReach>& lights);
  float first_share(const Node& node, const Vec3f& point, const Vec3f& normal,
                    const std::uint8_t* seen) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_of_;  // by light
};

}  // namespace msbvh
