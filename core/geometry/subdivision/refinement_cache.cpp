#include "core/geometry/subdivision/refinement_cache.h"

#include <bit>
#include <concepts>
#include <utility>
#include <vector>

namespace msbvh {
namespace {

// 64 bits of what is added, in its order: the mixing step of Sebastiano Vigna's SplitMix64.
class Hash {
 public:
  void add(std::uint64_t value) {
    state_ += 0x9e3779b97f4a7c15u + value;
    state_ = (state_ ^ (state_ >> 30)) * 0xbf58476d1ce4e5b9u;
    state_ = (state_ ^ (state_ >> 27)) * 0x94d049bb133111ebu;
    state_ ^= state_ >> 31;
  }
  void add(const std::vector<std::uint32_t>& values) {
    add(values.size());
    for (const std::uint32_t value : values) add(value);
  }
  void add(const std::vector<float>& values) {
    add(values.size());
    for (const float value : values) add(std::bit_cast<std::uint32_t>(value));
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

std::uint64_t hash_of(const Cage& cage) {
  Hash hash;
  hash.add(cage.vertex_count);
  hash.add(cage.face_vertex_counts);
  hash.add(cage.face_vertex_indices);
  hash.add(cage.holes);
  hash.add(cage.crease_indices);
  hash.add(cage.crease_sharpnesses);
  hash.add(cage.corner_indices);
  hash.add(cage.corner_sharpnesses);
  return hash.value();
}

std::uint64_t hash_of(std::uint64_t cage, const EdgeLevels& levels) {
  Hash hash;
  hash.add(cage);
  hash.add(levels.of_edges);
  return hash.value();
}

}  // namespace

RefinementCache::Items::iterator RefinementCache::find_cage(std::uint64_t hash, const Cage& cage) {
  const auto [begin, end] = by_hash_.equal_range(hash);
  for (auto i = begin; i != end; ++i) {
    if (!i->second->mesh && same_topology(i->second->cage->cage(), cage)) return i->second;
  }
  return items_.end();
}

RefinementCache::Items::iterator RefinementCache::find_mesh(std::uint64_t hash, const RefinableCage& cage,
                                                            const EdgeLevels& levels) {
  const auto [begin, end] = by_hash_.equal_range(hash);
  for (auto i = begin; i != end; ++i) {
    const Item& item = *i->second;
    if (item.mesh && item.cage.get() == &cage && item.levels == levels) return i->second;
  }
  return items_.end();
}

RefinementCache::Items::iterator RefinementCache::add(Item item) {
  items_.push_front(std::move(item));
  by_hash_.emplace(items_.front().hash, items_.begin());
  return items_.begin();
}

// A cage grows with the surfaces that are made of it.
void RefinementCache::measure(Items::iterator item) {
  bytes_ -= item->bytes;
  item->bytes = item->mesh ? item->mesh->bytes() + item->levels.of_edges.capacity() * sizeof(std::uint32_t)
                           : item->cage->bytes();
  bytes_ += item->bytes;
}

void RefinementCache::drop_oldest() {
  const auto oldest = std::prev(items_.end());
  const auto [begin, end] = by_hash_.equal_range(oldest->hash);
  for (auto i = begin; i != end; ++i) {
    if (i->second != oldest) continue;
    by_hash_.erase(i);
    break;
  }
  bytes_ -= oldest->bytes;
  items_.erase(oldest);
}

std::shared_ptr<const RefinedMesh> RefinementCache::mesh(Cage cage, std::span<const Vec3f* const> poses,
                                                         const EdgeLevel& level, std::uint64_t most_points) {
  const std::uint64_t cage_hash = hash_of(cage);
  auto kept = find_cage(cage_hash, cage);
  ++(kept == items_.end() ? counts_.cages_made : counts_.cages_kept);
  if (kept == items_.end())
    kept = add({.hash = cage_hash, .cage = std::make_shared<RefinableCage>(std::move(cage))});
  EdgeLevels levels = kept->cage->edge_levels(poses, level, most_points);
  const std::uint64_t mesh_hash = hash_of(cage_hash, levels);
  auto found = find_mesh(mesh_hash, *kept->cage, levels);
  ++(found == items_.end() ? counts_.meshes_made : counts_.meshes_kept);
  if (found == items_.end()) {
    auto made = std::make_shared<const RefinedMesh>(kept->cage, levels);
    found =
        add({.hash = mesh_hash, .cage = kept->cage, .levels = std::move(levels), .mesh = std::move(made)});
  }
  std::shared_ptr<const RefinedMesh> result = found->mesh;
  use(found);
  use(kept);
  measure(found);
  measure(kept);
  while (bytes_ > most_bytes_ && !items_.empty()) drop_oldest();
  return result;
}

}  // namespace msbvh
