// Long checks. `make test` runs a fixed-seed sample of each; with MSBVH_SOAK set (`make soak`) each runs
// whole.
//
// A long check is an ordinary test case in the suite "slow" whose name begins with "soak: ". It takes its
// size from soak_count() and leaves a line for docs/soak.md by soak_figure().
#pragma once

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string_view>

namespace msbvh::test {

inline bool is_soak() { return std::getenv("MSBVH_SOAK") != nullptr; }

inline std::uint64_t soak_count(std::uint64_t sample, std::uint64_t whole) {
  return is_soak() ? whole : sample;
}

// What a check measured, in a few words with units; appended to the file that MSBVH_SOAK_FIGURES names, if
// any.
inline void soak_figure(std::string_view check, std::string_view figure) {
  if (const char* file = std::getenv("MSBVH_SOAK_FIGURES")) {
    std::ofstream(file, std::ios::app) << check << '\t' << figure << '\n';
  }
}

}  // namespace msbvh::test
