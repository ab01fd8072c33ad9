#include "core/cost/cost_tally.h"

namespace msbvh {
namespace {

TalliedWork work_of(const TraceVisit& visit) {
  return {visit.nodes * TalliedWork::kParts, visit.instances * TalliedWork::kParts, visit.blocks,
          visit.primitives};
}

// Rounded down.
std::uint64_t part_of(std::uint64_t parts, double share) {
  return static_cast<std::uint64_t>(static_cast<double>(parts) * share);
}

}  // namespace

CostTally::CostTally(const SceneRows& rows, const SceneOwners& owners, const CostModel& model)
    : rows_(rows), owners_(owners), model_(model), work_(rows.size()), ray_cost_(rows.size(), 0.0) {}

double CostTally::cost_of(const TalliedWork& work, std::uint32_t row) const {
  return work.nodes() + model_.instance * work.instances() +
         model_.of_blocks(rows_.id(row).kind()) * static_cast<double>(work.blocks);
}

double CostTally::cost(std::uint32_t row) const { return cost_of(work_[row], row); }
double CostTally::empty_cost() const { return empty_.nodes() + model_.instance * empty_.instances(); }

void CostTally::add(const std::vector<TraceVisit>& ray) {
  TalliedWork shared;
  for (const TraceVisit& visit : ray) {
    const std::uint32_t owner = owners_.owner(visit);
    if (owner == kOwnedByMany) {
      shared += work_of(visit);
    } else if (owner == kOwnedByNone) {
      empty_ += work_of(visit);
    } else {
      add_own(work_of(visit), owner);
    }
  }
  split(shared);
}

void CostTally::add_own(const TalliedWork& work, std::uint32_t row) {
  work_[row] += work;
  if (ray_cost_[row] == 0.0) ray_rows_.push_back(row);
  ray_cost_[row] += cost_of(work, row);
}

// What rounding leaves goes to the last row, so that nothing is lost. Ends the ray.
void CostTally::split(TalliedWork shared) {
  double all = 0.0;
  for (const std::uint32_t row : ray_rows_) all += ray_cost_[row];
  const TalliedWork whole = shared;
  for (const std::uint32_t row : ray_rows_) {
    const bool last = row == ray_rows_.back();
    const double share = ray_cost_[row] / all;
    TalliedWork part;
    part.node_parts = last ? shared.node_parts : part_of(whole.node_parts, share);
    part.instance_parts = last ? shared.instance_parts : part_of(whole.instance_parts, share);
    work_[row] += part;
    shared.node_parts -= part.node_parts;
    shared.instance_parts -= part.instance_parts;
    ray_cost_[row] = 0.0;
  }
  empty_ += shared;
  ray_rows_.clear();
}

CostTally& CostTally::operator+=(const CostTally& other) {
  for (std::size_t row = 0; row < work_.size(); ++row) work_[row] += other.work_[row];
  empty_ += other.empty_;
  return *this;
}

}  // namespace msbvh
