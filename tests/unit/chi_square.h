// Pearson's test of samples against the density that they should have.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <doctest/doctest.h>
#include <vector>

namespace msbvh {

// By cells: each one's share of the density, and how many of `count` samples fell into it; `drawn` of them
// fell into any. `missed`: what midpoints miss of the shares, a cell. Returns how many cells had enough to
// tell.
inline int check_chi_square(const std::vector<double>& expected, const std::vector<double>& found,
                            std::uint32_t count, double drawn, double missed) {
  double chi = 0.0, share = 0.0;
  int cells = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    share += expected[i];
    const double mean = expected[i] * count;
    if (mean < 8.0) continue;
    chi += (found[i] - mean) * (found[i] - mean) / mean;
    ++cells;
  }
  CHECK(share == doctest::Approx(drawn / count).epsilon(0.01));
  CHECK(chi < cells + 5.0 * std::sqrt(2.0 * cells) + missed * cells);  // five standard deviations
  return cells;
}

}  // namespace msbvh
