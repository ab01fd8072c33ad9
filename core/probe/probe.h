// The stability of a scene's trees, tried out: rays of every aim, by every kernel that this machine runs,
// held against the oracle, and rays that start inside of closed meshes, of which none may get out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/bvh/bvh.h"
#include "core/trace/tracer.h"

namespace msbvh {

struct ProbeSettings {
  std::size_t rays = 100'000;  // of each probe and instruction set
  std::uint64_t seed = 1;
  // How many primitives the oracle may test for each probe and instruction set; it takes all of them for a
  // ray. It judges one ray at least.
  double oracle_tests = 2e7;
};

struct ProbeResult {
  std::string probe{};  // "rays at edges", "rays from inside closed meshes", ...
  InstructionSet set = InstructionSet::kSse4;
  std::size_t rays = 0;    // traced one by one, interleaved and in packets
  std::size_t judged = 0;  // by the oracle
  std::size_t wrong = 0;
  std::string first{};  // of the wrong ones: which ray and what; empty: none
};

// Finished share in [0, 1]; false cancels.
using ProbeProgress = std::function<bool(double)>;

struct ProbeReport {
  std::vector<ProbeResult> results;
  std::size_t meshes = 0, closed_meshes = 0;  // shown, each once however many instances show it
};

// Of the tree and of what its instances show. Throws Cancelled.
ProbeReport probe(const Bvh& world, const ProbeSettings& settings, const ProbeProgress& progress = {});

}  // namespace msbvh
