#include "delegate/translate/coarser_tally.h"

#include <algorithm>
#include <cstdint>
#include <unordered_set>

#include "delegate/translate/translator.h"

namespace msbvh::translate {
namespace {

void take(const Saving& saving, std::vector<TrackReport>& reports) {
  reports[saving.report].coarser -= saving.coarser;
  reports[saving.report].keys_saved -= saving.keys_saved;
}

std::uint64_t key_of(GeometryId id) { return std::uint64_t(id.kind()) << 32 | id.index(); }

}  // namespace

void CoarserTally::add(GeometryId world, const TrackReport& report, std::size_t place) {
  if (report.coarser > 0) world_.push_back({world, {place, report.coarser, report.keys_saved}});
}

void CoarserTally::add(std::vector<std::size_t> sets, std::vector<Saving> savings) {
  std::erase_if(savings, [](const Saving& saving) { return saving.coarser == 0; });
  if (!savings.empty()) in_sets_.push_back({std::move(sets), std::move(savings)});
}

void CoarserTally::leave_out(const std::vector<LeftOut>& prims, std::vector<TrackReport>& reports) const {
  std::unordered_set<std::size_t> sets;
  std::unordered_set<std::uint64_t> world;
  for (const LeftOut& prim : prims) {
    sets.insert(prim.sets.begin(), prim.sets.end());
    for (const GeometryId id : prim.world) world.insert(key_of(id));
  }
  for (const auto& [id, saving] : world_) {
    if (world.contains(key_of(id))) take(saving, reports);
  }
  for (const InSets& thing : in_sets_) {
    if (!std::ranges::all_of(thing.sets, [&](std::size_t set) { return sets.contains(set); })) continue;
    for (const Saving& saving : thing.savings) take(saving, reports);
  }
}

}  // namespace msbvh::translate
