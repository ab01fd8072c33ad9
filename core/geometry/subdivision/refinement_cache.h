// Refined cages and their triangles, kept from mesh to mesh and from frame to frame.
//
// What is kept is what a new one would be, bit by bit: a cage is taken again where its faces, creases, rules
// and face-varying topology are equal, triangles where the levels of all edges are, too. Hence a picture does
// not depend on what was drawn before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <span>
#include <unordered_map>

#include "core/geometry/subdivision/refined_mesh.h"

namespace msbvh {

// How often something was made, and how often taken again.
struct RefinementCounts {
  std::size_t cages_made = 0, cages_kept = 0, meshes_made = 0, meshes_kept = 0;
};

// Not thread-safe.
class RefinementCache {
 public:
  static constexpr std::size_t kMostBytes = std::size_t(256) << 20;

  // What was used longest ago goes first where there would be more than `most_bytes`.
  explicit RefinementCache(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

  // As RefinedMesh's constructor. A mesh's cage may have the name of an equal one.
  std::shared_ptr<const RefinedMesh> mesh(Cage cage, std::span<const Vec3f* const> poses,
                                          const EdgeLevel& level, std::uint64_t most_points);

  std::size_t bytes() const { return bytes_; }
  const RefinementCounts& counts() const { return counts_; }

 private:
  struct Item {
    std::uint64_t hash;
    std::shared_ptr<RefinableCage> cage;
    EdgeLevels levels{};
    std::shared_ptr<const RefinedMesh> mesh{};  // null: the cage itself
    std::size_t bytes = 0;
  };
  using Items = std::list<Item>;

  Items::iterator find_cage(std::uint64_t hash, const Cage& cage);
  Items::iterator find_mesh(std::uint64_t hash, const RefinableCage& cage, const EdgeLevels& levels);
  Items::iterator add(Item item);
  void use(Items::iterator item) { items_.splice(items_.begin(), items_, item); }
  void measure(Items::iterator item);
  void drop_oldest();

  std::size_t most_bytes_, bytes_ = 0;
  Items items_;  // the last used first; a cage before its meshes
  std::unordered_multimap<std::uint64_t, Items::iterator> by_hash_;
  RefinementCounts counts_;
};

}  // namespace msbvh
