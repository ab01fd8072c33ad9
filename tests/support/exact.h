// Exact arithmetic on floats, for judges that know no tolerance: numbers as sums of doubles that do not
// overlap (expansions). J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust
// Geometric Predicates", Discrete & Computational Geometry 18, 1997.
//
// Why not a library's rationals: all that is asked here are signs of sums of products of at most three
// differences of floats, without a division. Such a product is a sum of 16 doubles at most, between 2^-447
// and 2^387: far from where doubles overflow or lose bits, so that every step is exact. A check in plain
// doubles with its error bound answers nearly always; rationals would be a dependency, and slower.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace msbvh::test {

// A double and what it lacks: hi + lo is exact, |lo| <= 2^-53 |hi|.
struct TwoDoubles {
  double hi = 0.0, lo = 0.0;
};
inline TwoDoubles two_sum(double a, double b) {
  const double sum = a + b, b_part = sum - a, a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}
inline TwoDoubles two_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}
// Of two floats.
inline TwoDoubles difference(float a, float b) { return two_sum(double(a), -double(b)); }

// An exact number.
class Expansion {
 public:
  Expansion() = default;
  explicit Expansion(const TwoDoubles& a) {
    add(a.lo);
    add(a.hi);
  }

  // Shewchuk's Grow-Expansion, zeros left out: the parts stay free of overlaps, least first.
  void add(double b) {
    double sum = b;
    std::size_t kept = 0;
    for (const double part : parts_) {
      const TwoDoubles s = two_sum(sum, part);
      if (s.lo != 0.0) parts_[kept++] = s.lo;
      sum = s.hi;
    }
    parts_.resize(kept);
    if (sum != 0.0) parts_.push_back(sum);
  }
  void add(const TwoDoubles& a) {
    add(a.lo);
    add(a.hi);
  }
  void add(const Expansion& b, double sign) {
    for (const double part : b.parts_) add(sign * part);
  }
  Expansion times(const TwoDoubles& b) const {
    Expansion product;
    for (const double part : parts_) {
      product.add(two_product(part, b.lo));
      product.add(two_product(part, b.hi));
    }
    return product;
  }
  // -1, 0 or 1.
  int sign() const { return parts_.empty() ? 0 : parts_.back() > 0.0 ? 1 : -1; }

 private:
  std::vector<double> parts_;
};

// Of a sum whose terms are exact.
inline int sign_of_sum(std::span<const double> terms) {
  double sum = 0.0, size = 0.0;
  for (const double term : terms) {
    sum += term;
    size += std::abs(term);
  }
  // A rounding a term, of a partial sum that is no larger than `size`.
  const double error = 0x1p-53 * double(terms.size() + 1) * size;
  if (sum > error) return 1;
  if (sum < -error) return -1;
  Expansion exact;
  for (const double term : terms) exact.add(term);
  return exact.sign();
}

using Row = std::array<TwoDoubles, 3>;
constexpr Row kOnes = {TwoDoubles{1.0, 0.0}, TwoDoubles{1.0, 0.0}, TwoDoubles{1.0, 0.0}};

namespace detail {

inline int exact_sign_of_determinant(const Row& a, const Row& b, const Row& c) {
  Expansion sum;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    sum.add(Expansion(a[i]).times(b[j]).times(c[k]), 1.0);
    sum.add(Expansion(a[i]).times(b[k]).times(c[j]), -1.0);
  }
  return sum.sign();
}

}  // namespace detail

// The sign of the determinant of three rows, whose entries are differences of floats, or 1.
inline int sign_of_determinant(const Row& a, const Row& b, const Row& c) {
  // Each entry lacks 2^-53 of itself, each product of three two roundings more, the sum five: 10 of 2^-53.
  constexpr double kError = 16 * 0x1p-53;
  double sum = 0.0, size = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double even = a[i].hi * b[j].hi * c[k].hi, odd = a[i].hi * b[k].hi * c[j].hi;
    sum += even - odd;
    size += std::abs(even) + std::abs(odd);
  }
  if (sum > kError * size) return 1;
  if (sum < -kError * size) return -1;
  return detail::exact_sign_of_determinant(a, b, c);
}

}  // namespace msbvh::test
