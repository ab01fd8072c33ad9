// Which parts of a scene carry the tracks that have fewer keys outside of the picture, so that what no ray
// reaches is not counted among them.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/scene/scene.h"
#include "delegate/translate/unreached.h"

namespace msbvh::translate {

struct TrackReport;

// A part of what one report counts.
struct Saving {
  std::size_t report = 0;  // its place among reports
  std::size_t coarser = 0, keys_saved = 0;
};

class CoarserTally {
 public:
  void add(GeometryId world, const TrackReport& report, std::size_t place);
  // A thing that stands in sets of a scene, of one each for its prototype's parts, given by their places
  // among the scene's instances.
  void add(std::vector<std::size_t> sets, std::vector<Saving> savings);

  // Takes out of `reports` what stands in nothing else than what was left out.
  void leave_out(const std::vector<LeftOut>& prims, std::vector<TrackReport>& reports) const;

 private:
  struct InSets {
    std::vector<std::size_t> sets;
    std::vector<Saving> savings;
  };
  std::vector<std::pair<GeometryId, Saving>> world_;
  std::vector<InSets> in_sets_;
};

}  // namespace msbvh::translate
