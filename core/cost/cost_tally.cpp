#include "core/cost/cost_tally.h"

#include <utility>

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
    : rows_(rows),
      owners_(owners),
      model_(model),
      work_(rows.size()),
      ray_(rows.size()),
      inside_(rows.size()) {}

double CostTally::cost_of(const TalliedWork& work, std::uint32_t row) const {
  const double tests =
      work.nodes() + model_.of_block(rows_.id(row).kind()) * static_cast<double>(work.blocks);
  return model_.of_motion(rows_.form(row)) * tests + model_.instance * work.instances();
}

double CostTally::cost(std::uint32_t row) const { return cost_of(work_[row], row); }
double CostTally::empty_cost() const { return empty_.nodes() + model_.instance * empty_.instances(); }

void CostTally::add(const std::vector<TraceVisit>& ray) {
  for (const TraceVisit& visit : ray) {
    const std::uint32_t instance = owners_.instance(visit), owner = owners_.owner(visit);
    if (instance != instance_) end_instance();
    instance_ = instance;
    if (owner < rows_.size()) {
      add_own(work_of(visit), owner);
    } else {
      (instance == kNoInstance ? ray_shared_ : inside_shared_) += work_of(visit);
    }
  }
  end_instance();
  const std::vector<RowWeight> met = ray_.costs();
  empty_ += split(std::exchange(ray_shared_, {}), met);
  ray_.clear();
}

void CostTally::add_own(const TalliedWork& work, std::uint32_t row) {
  const double cost = cost_of(work, row);
  work_[row] += work;
  ray_.add(row, cost);
  if (instance_ != kNoInstance) inside_.add(row, cost);
}

// What was done in it is its geometry's, also where the ray got no further than what several have.
void CostTally::end_instance() {
  if (instance_ == kNoInstance) return;
  const std::vector<RowWeight> met = inside_.costs();
  empty_ += split(std::exchange(inside_shared_, {}), met.empty() ? owners_.shown_by(instance_) : met);
  inside_.clear();
  instance_ = kNoInstance;
}

// What rounding leaves goes to the last row, so that nothing is lost. Returns what is nobody's.
TalliedWork CostTally::split(TalliedWork shared, const std::vector<RowWeight>& among) {
  if (shared.node_parts == 0 && shared.instance_parts == 0) return {};
  double all = 0.0;
  for (const RowWeight& each : among) all += each.weight;
  const TalliedWork whole = shared;
  for (const RowWeight& each : among) {
    const bool last = &each == &among.back();
    TalliedWork part;
    part.node_parts = last ? shared.node_parts : part_of(whole.node_parts, each.weight / all);
    part.instance_parts = last ? shared.instance_parts : part_of(whole.instance_parts, each.weight / all);
    add_own(part, each.row);
    shared.node_parts -= part.node_parts;
    shared.instance_parts -= part.instance_parts;
  }
  return shared;
}

CostTally& CostTally::operator+=(const CostTally& other) {
  for (std::size_t row = 0; row < work_.size(); ++row) work_[row] += other.work_[row];
  empty_ += other.empty_;
  return *this;
}

}  // namespace msbvh
