// What rays cost, by whose geometry they tested.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cost/cost_model.h"
#include "core/cost/scene_owners.h"
#include "core/cost/scene_rows.h"
#include "core/trace/trace_visit.h"

namespace msbvh {

struct TalliedWork {
  // Nodes and instances in 1 / kParts: whole numbers add up alike in any order, on any number of threads.
  static constexpr std::uint64_t kParts = 1u << 20;
  std::uint64_t node_parts = 0, instance_parts = 0;
  std::uint64_t blocks = 0, primitives = 0;

  double nodes() const { return static_cast<double>(node_parts) / kParts; }
  double instances() const { return static_cast<double>(instance_parts) / kParts; }
  TalliedWork& operator+=(const TalliedWork& other) {
    node_parts += other.node_parts;
    instance_parts += other.instance_parts;
    blocks += other.blocks;
    primitives += other.primitives;
    return *this;
  }
};

// What some rows cost, in the order in which they came up.
class RowCosts {
 public:
  explicit RowCosts(std::uint32_t rows) : place_(rows, kNone) {}

  void add(std::uint32_t row, double cost) {
    if (place_[row] == kNone) {
      place_[row] = static_cast<std::uint32_t>(costs_.size());
      costs_.push_back({row, 0.0});
    }
    costs_[place_[row]].weight += cost;
  }
  void clear() {
    for (const RowWeight& cost : costs_) place_[cost.row] = kNone;
    costs_.clear();
  }
  const std::vector<RowWeight>& costs() const { return costs_; }

 private:
  std::vector<RowWeight> costs_;
  std::vector<std::uint32_t> place_;  // there, by row
};

class CostTally {
 public:
  CostTally(const SceneRows& rows, const SceneOwners& owners, const CostModel& model);

  // All of one ray. A node below which one row's geometry stands is that row's, whether or not the ray gets
  // to a leaf. What is several rows' is split by what this ray costs each by itself: in an instance, among
  // those that it shows, and where the ray gets to none of them alone, by their leaf entries; in the world's
  // tree among all, and if it meets none of them, it is empty space's.
  void add(const std::vector<TraceVisit>& ray);
  CostTally& operator+=(const CostTally& other);

  const TalliedWork& of(std::uint32_t row) const { return work_[row]; }
  const TalliedWork& of_empty_space() const { return empty_; }
  double cost(std::uint32_t row) const;
  double empty_cost() const;

 private:
  double cost_of(const TalliedWork& work, std::uint32_t row) const;
  void add_own(const TalliedWork& work, std::uint32_t row);
  void end_instance();
  TalliedWork split(TalliedWork shared, const std::vector<RowWeight>& among);

  const SceneRows& rows_;
  const SceneOwners& owners_;
  const CostModel model_;
  std::vector<TalliedWork> work_;  // by row
  TalliedWork empty_;
  // Of the ray at hand, and of the instance that it is in: what they cost rows, and what several have.
  RowCosts ray_, inside_;
  TalliedWork ray_shared_, inside_shared_;
  std::uint32_t instance_ = kNoInstance;
};

}  // namespace msbvh
