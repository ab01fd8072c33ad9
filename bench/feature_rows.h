// One feature with and without: the same rays through both trees, interleaved, one line of JSON.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "bench/ray_sets.h"
#include "core/bvh/bvh.h"

namespace msbvh::bench {

struct FeatureTree {
  std::shared_ptr<const void> owner;  // of `bvh`
  const Bvh* bvh = nullptr;
  std::uint64_t bytes = 0;  // all that traversal reads
  double build_seconds = 0.0;
};

struct FeatureSide {
  std::string name;  // the settings, or the way of asking
  std::string keys;  // of its tracks
  // Anew at every call. Empty on the side with the feature: both sides ask the same tree.
  std::function<FeatureTree()> build;
  bool at_once = true;  // many rays at once, or one by one
};

struct Feature {
  std::string name, what;
  std::string source;  // where it is described: of the paper, or a document of ours
  std::string test;    // the files that test it
};

struct FeatureRow {
  Feature feature;
  std::shared_ptr<const Scene> scene;  // for its camera
  std::string scene_name;
  RayKind rays = RayKind::kRandom;
  bool any_hit = false;
  FeatureSide without, with;
};

struct FeatureRun {
  std::size_t rays = 1u << 15;
  int rounds = 9;
  int builds = 3;
  std::uint32_t seed = 1;
};

// Builds on the threads of the calling arena, rays on one.
std::string measure(const FeatureRow& row, const FeatureRun& run);

}  // namespace msbvh::bench
