// How one set of references is divided: which split, and the division itself. Knows nothing of nodes.
#pragma once

#include "core/build/object_split.h"
#include "core/build/partition.h"
#include "core/build/settings.h"
#include "core/build/spatial_split.h"

namespace msbvh {

// References that a node is to be built over.
struct WorkSet {
  std::span<Reference> references;
  SetBounds bounds;
  std::size_t room = 0;     // references that spatial splits may add, below this node
  std::uint32_t depth = 0;  // of the binary node
  std::uint32_t patience =
      0;  // spatial splits to be looked for in vain, one after the other, before giving up

  std::size_t size() const { return references.size(); }
  std::size_t space_for(const SpatialSplit& split) const { return std::min(room, split.cuts(size())); }
};

enum class SplitKind : std::uint8_t { kLeaf, kObject, kSpatial, kHalves, kMotion };

struct SplitChoice {
  SplitKind kind = SplitKind::kLeaf;
  ObjectBinning binning;
  ObjectSplit object;
  SpatialSplit spatial;
  std::uint32_t patience = 0;  // of the children
};

class Splitter {
 public:
  Splitter(const CentrePose& pose, const BuildSettings& settings, float root_area);

  static WorkSet root(std::span<Reference> references, const SetBounds& bounds, std::size_t room);
  SplitChoice choose(const WorkSet& set) const;
  // What moves apart from the rest (motion_split.h), where the root is to be split so; else as choose().
  SplitChoice choose_root(const WorkSet& set) const;
  // Neither child is empty. Right parts of cut references go behind the set's, where there must be space for
  // set.space_for() of them.
  void divide(const WorkSet& set, const SplitChoice& choice, WorkSet& left, WorkSet& right) const;

  const Primitives& primitives() const { return pose_.primitives(); }

 private:
  bool wants_spatial_split(const WorkSet& set, const ObjectSplit& object, float area) const;
  // Whether a sample of the set would rather be cut.
  bool promises_gain(const WorkSet& set, const SplitChoice& choice) const;

  const CentrePose& pose_;
  const BuildSettings& settings_;
  const float root_area_;
  const std::size_t min_spatial_references_;
};

}  // namespace msbvh
