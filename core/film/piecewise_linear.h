// Distributions whose density is linear between knots, sampled exactly by the inverse of their cumulative
// distribution, which is monotone: well-spread numbers stay well spread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace msbvh {

struct Knot {
  float place = 0.0f;
  float weight = 0.0f;  // the density's, in any unit
  constexpr bool operator==(const Knot&) const = default;
};

// Knots whose places do not decrease; two at one place are a step. Weights are finite and at least 0, and
// some of them are above 0 over a stretch.
bool is_density(std::span<const Knot> knots);

// The integral of the weights, linear between knots and 0 beyond them, from `begin` to `end`.
double integral(std::span<const Knot> knots, double begin, double end);

class PiecewiseLinear {
 public:
  PiecewiseLinear() = default;
  explicit PiecewiseLinear(std::span<const Knot> knots);  // is_density()

  bool empty() const { return pieces_.empty(); }
  // `u` in [0, 1): the place below which a share u of the density lies.
  double sample(double u) const;

 private:
  struct Piece {
    double begin, length, w0, w1;
    double area_before;
  };
  std::vector<Piece> pieces_;  // of some area each
  double area_ = 0.0;
};

}  // namespace msbvh
