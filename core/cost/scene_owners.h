// Whose geometry a ray tested, and whose geometry trees were built of: rows of SceneRows.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/cost/scene_rows.h"
#include "core/cost/tree_owners.h"
#include "core/shade/scene_index.h"
#include "core/trace/trace_visit.h"

namespace msbvh {

struct RowWeight {
  std::uint32_t row;
  double weight;
};

class SceneOwners {
 public:
  // All must outlive it. `world` is the tree that `index` counts in.
  SceneOwners(const SceneIndex& index, const SceneRows& rows, const Bvh& world);

  // kOwnedByMany: a node above several rows' geometry, or an instance that shows several.
  std::uint32_t owner(const TraceVisit& visit) const;
  // The instance that a visit is to or in; kNoInstance: what is in the world itself.
  std::uint32_t instance(const TraceVisit& visit) const;
  // What an instance shows: rows and their leaf entries, in the order of rows.
  const std::vector<RowWeight>& shown_by(std::uint32_t instance) const {
    return of_instance_[instance]->references.of_row;
  }

  // By row: what it has of the seconds that each tree's build took, in proportion to its leaf entries there.
  // In the world's tree an instance's entry is its prototype's, and split in the proportions of that. Trees
  // that were kept from the frame before took no time. That a build takes n log n, and that geometry which
  // is split costs more an entry, is left out.
  std::vector<double> build_seconds() const;
  // Likewise of the bytes that each tree holds, also of trees that were kept.
  std::vector<double> tree_bytes() const;

 private:
  // Leaf entries: triangles, windows of grids, pieces of curves, points.
  struct References {
    std::vector<RowWeight> of_row;  // in the order of rows
    double all = 0.0;

    void split(double amount, std::vector<double>& by_row) const;
  };
  struct Object {
    const Bvh* tree;
    References references;
    std::uint64_t shown = 0;  // leaf entries of its instances in the world
    TreeOwners owners;
  };

  // What each tree has of a quantity, split by leaf entries.
  template <typename Quantity>  // double quantity(const BvhStatistics&)
  std::vector<double> split(const Quantity& quantity) const;
  std::unique_ptr<Object> make_object(const Bvh& tree, std::uint32_t instance) const;
  std::vector<Object*> add_objects();  // of each instance
  std::uint32_t add_world_block(const BlockHeader& block);
  static References references_of(const std::unordered_map<std::uint32_t, std::uint64_t>& counts);
  std::uint32_t row_of(GeometryId geometry, std::uint32_t instance) const;

  const SceneIndex& index_;
  const SceneRows& rows_;
  const Bvh& world_;
  std::vector<std::unique_ptr<Object>> objects_;  // in the order in which instances show them
  std::vector<Object*> of_instance_;
  std::unordered_map<std::uint32_t, std::uint64_t> in_world_;  // leaf entries by row
  std::uint64_t world_references_ = 0;                         // those and the instances'
  TreeOwners world_owners_;                                    // made last: it asks for the others
};

}  // namespace msbvh
