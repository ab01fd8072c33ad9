// Rays from inside of closed moving shapes, of which none may get out, and into tubes and spheres, which must
// stop them: ours and a peer's, the same rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "bench/peer_library.h"
#include "bench/stability_scene.h"

namespace msbvh::bench {

struct StabilitySettings {
  std::size_t rays = 5'000;  // about; ten times as many of StabilityProbe::kInsidePlain
  std::uint32_t seed = 1;
  double oracle_tests = 2e6;  // primitives that the oracle tests for a cell and a side; one ray at least
  const PeerLibrary* peer = nullptr;   // with its robust flag
  std::function<void()> tick = [] {};  // between measurements; what it throws ends the run
};

// A JSON object. A side's leaks are those of the worst of its ways of being asked (ours: every instruction
// set that this machine has), and "rays AIM" and "leaks AIM" are those of an aim; `wrong` counts the judged
// rays whose answer, one at a time, is farther from double precision than core/trace/oracle.h states. null:
// not measured, since the peer has no tracks of this degree, or tubes of another shape, or there is none.
std::string run_stability(const StabilityCell& cell, const StabilitySettings& settings);

}  // namespace msbvh::bench
