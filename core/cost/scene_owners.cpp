#include "core/cost/scene_owners.h"

#include <algorithm>
#include <utility>

namespace msbvh {
namespace {

// A grid's window is one entry.
std::uint64_t references_in(const BlockHeader& block) {
  return block.kind == BlockKind::kGrid ? 1 : block.count;
}

}  // namespace

void SceneOwners::References::split(double amount, std::vector<double>& by_row) const {
  for (const auto& [row, count] : of_row) by_row[row] += amount * count / all;
}

SceneOwners::References SceneOwners::references_of(
    const std::unordered_map<std::uint32_t, std::uint64_t>& counts) {
  References references;
  for (const auto& [row, count] : counts) {
    references.of_row.push_back({row, static_cast<double>(count)});
    references.all += static_cast<double>(count);
  }
  std::ranges::sort(references.of_row, {}, &RowWeight::row);
  return references;
}

SceneOwners::SceneOwners(const SceneIndex& index, const SceneRows& rows, const Bvh& world)
    : index_(index),
      rows_(rows),
      world_(world),
      of_instance_(add_objects()),
      world_owners_(world, [&](const BlockHeader& block) { return add_world_block(block); }) {}

std::uint32_t SceneOwners::row_of(GeometryId geometry, std::uint32_t instance) const {
  Hit hit;
  hit.geometry = geometry;
  hit.instance = instance;
  return rows_.row(index_.resolve(hit));
}

std::unique_ptr<SceneOwners::Object> SceneOwners::make_object(const Bvh& tree, std::uint32_t instance) const {
  std::unordered_map<std::uint32_t, std::uint64_t> references;
  TreeOwners owners(tree, [&](const BlockHeader& block) {
    const std::uint32_t row = row_of(block.geometry(), instance);
    references[row] += references_in(block);
    return row;
  });
  return std::make_unique<Object>(Object{&tree, references_of(references), 0, std::move(owners)});
}

std::vector<SceneOwners::Object*> SceneOwners::add_objects() {
  std::vector<Object*> of_instance;
  std::unordered_map<const Bvh*, Object*> known;
  for (std::uint32_t i = 0; i < world_.instances.size(); ++i) {
    const Bvh& tree = *world_.instances[i].object;
    Object*& object = known[&tree];
    if (!object) object = objects_.emplace_back(make_object(tree, i)).get();
    of_instance.push_back(object);
  }
  return of_instance;
}

std::uint32_t SceneOwners::add_world_block(const BlockHeader& block) {
  if (block.kind == BlockKind::kInstance) {
    Object& object = *of_instance_[block.owner];
    ++world_references_;
    ++object.shown;
    return object.owners.of_root();
  }
  const std::uint32_t row = row_of(block.geometry(), kNoInstance);
  world_references_ += references_in(block);
  in_world_[row] += references_in(block);
  return row;
}

std::uint32_t SceneOwners::owner(const TraceVisit& visit) const {
  const bool in_object = visit.instance != kNoInstance;
  if (!visit.at.is_leaf())
    return in_object ? of_instance_[visit.instance]->owners.of_node(visit.at)
                     : world_owners_.of_node(visit.at);
  const BlockHeader& block = (in_object ? *of_instance_[visit.instance]->tree : world_).block(visit.at);
  if (block.kind == BlockKind::kInstance) return of_instance_[block.owner]->owners.of_root();
  return row_of(block.geometry(), visit.instance);
}

std::uint32_t SceneOwners::instance(const TraceVisit& visit) const {
  return visit.instances > 0 ? world_.block(visit.at).owner : visit.instance;
}

template <typename Quantity>
std::vector<double> SceneOwners::split(const Quantity& quantity) const {
  std::vector<double> by_row(rows_.size(), 0.0);
  const double world = quantity(world_.statistics);
  for (const std::unique_ptr<Object>& object : objects_) {
    const double shown = world_references_ ? double(object->shown) / double(world_references_) : 0.0;
    object->references.split(quantity(object->tree->statistics) + world * shown, by_row);
  }
  const References in_world = references_of(in_world_);
  if (in_world.all > 0.0) in_world.split(world * in_world.all / double(world_references_), by_row);
  return by_row;
}

std::vector<double> SceneOwners::build_seconds() const {
  return split([](const BvhStatistics& tree) { return tree.build_seconds; });
}

std::vector<double> SceneOwners::tree_bytes() const {
  return split(
      [](const BvhStatistics& tree) { return static_cast<double>(tree.total_bytes() + tree.grid_bytes); });
}

}  // namespace msbvh
