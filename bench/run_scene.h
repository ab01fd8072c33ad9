// Measures one scene: every builder of ours, and a peer beside them in the same run.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/peer_library.h"
#include "bench/ray_sets.h"
#include "bench/scene_classes.h"
#include "core/build/settings.h"

namespace msbvh::bench {

struct RunSettings {
  std::string name;                   // of the scene, in the rows
  std::vector<std::string> builders;  // names from core/build/settings.h; empty: all but those for comparison
  std::vector<TreeLayout> layouts{TreeLayout::kFull};  // each with each builder
  std::vector<unsigned> threads{1, 0};
  std::vector<RayKind> kinds{std::begin(kRayKinds), std::end(kRayKinds)};
  std::size_t rays = 1u << 17;  // of each kind
  int repetitions = 5;
  int build_repetitions = 3;  // fewer where builds take long
  std::uint32_t seed = 1;
  double oracle_tests = 2e7;              // triangles that the oracle tests for each builder and kind of ray
  std::vector<bool> robust{true, false};  // the peer with its robust flag and without; ours is always robust
  const PeerLibrary* peer = nullptr;
  std::function<void()> tick = [] {};  // between measurements; what it throws ends the run
};

// JSON objects, one for each builder, kind of ray, number of threads and value of the peer's robust flag.
std::vector<std::string> run_scene(const BenchScene& scene, const RunSettings& settings);

}  // namespace msbvh::bench
