// Owen-scrambled Sobol' points, two dimensions at a time, each pair under a name.
//
// B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020. Every named pair is the (0,2)-sequence
// of the first two Sobol' dimensions, shuffled and scrambled by a hash of seed, pixel, name and depth.
// Nothing depends on the order in which a path draws, so that switching an effect off does not change the
// noise of the rest.
//
// The pair that places a sample in its pixel is scrambled but not shuffled, and sample s of N lies in time
// stratum [s, s + 1) / N: (time, x, y) is then a scrambled Hammersley set, and the samples come in the order
// of time.
#pragma once

#include <cstdint>

namespace msbvh {

struct Point2 {
  float x, y;  // in [0, 1)
};

enum class Dimension : std::uint32_t {
  kPixel,    // position in the pixel
  kTime,     // jitter within the time stratum
  kOpacity,  // whether a surface is seen or seen through
  kLight,    // point on a light
  kBounce,   // direction of the next ray
  kLens      // point on the lens
};

namespace sobol {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// The second Sobol' dimension with its bits reversed: Pascal's triangle modulo 2 times the index. The
// triangle of size 2n is made of three of size n, hence the five steps instead of a loop over 32 direction
// numbers.
constexpr std::uint32_t pascal(std::uint32_t index) {
  index ^= (index >> 16) & 0x0000ffffu;
  index ^= (index >> 8) & 0x00ff00ffu;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 2) & 0x33333333u;
  return index ^ ((index >> 1) & 0x55555555u);
}

// Owen scrambling of a number whose bits are reversed: each bit is flipped by a hash of the bits below it.
// The hash of Laine and Karras with the constants of N. Vegdahl, "Building a Better LK Hash", 2021.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  return x ^ (x * 0x53a22864u);
}

// The 24 leading bits: all that a float in [0, 1) holds without rounding up to 1.
constexpr float to_unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

// Point `index` of the two-dimensional sequence, both dimensions scrambled.
constexpr Point2 point(std::uint32_t index, std::uint32_t seed_x, std::uint32_t seed_y) {
  return {to_unit_float(reverse_bits(scramble_reversed(index, seed_x))),
          to_unit_float(reverse_bits(scramble_reversed(pascal(index), seed_y)))};
}

// A permutation of the indices that keeps every aligned block of 2^m together.
constexpr std::uint32_t shuffle(std::uint32_t index, std::uint32_t seed) {
  return reverse_bits(scramble_reversed(reverse_bits(index), seed));
}

}  // namespace sobol

// C. Wellons, "Prospecting for Hash Functions", 2018: the 32-bit mixer lowbias32.
constexpr std::uint32_t hash(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}
constexpr std::uint32_t hash(std::uint32_t seed, std::uint32_t x) {
  return hash(seed ^ (hash(x + 0x9e3779b9u)));
}

// The sample `index` of one pixel. Cheap to make.
class Sampler {
 public:
  constexpr Sampler(std::uint32_t seed, std::uint32_t pixel_x, std::uint32_t pixel_y, std::uint32_t index)
      : pixel_(hash(hash(hash(seed), pixel_x), pixel_y)), index_(index) {}

  // Position in the pixel: see the head of the file.
  constexpr Point2 pixel_position() const {
    const std::uint32_t key = hash(pixel_, static_cast<std::uint32_t>(Dimension::kPixel));
    return sobol::point(index_, hash(key, 0), hash(key, 1));
  }

  // `depth` counts the vertices of the path, `which` the lights or layers at one of them.
  constexpr Point2 pair(Dimension dimension, std::uint32_t depth, std::uint32_t which = 0) const {
    const std::uint32_t key = hash(hash(hash(pixel_, static_cast<std::uint32_t>(dimension)), depth), which);
    return sobol::point(sobol::shuffle(index_, key), hash(key, 0), hash(key, 1));
  }

  // The shutter time of this sample out of `count`, in its stratum.
  constexpr float time(std::uint32_t count) const {
    const double jitter = pair(Dimension::kTime, 0).x;
    return static_cast<float>((index_ + jitter) / count);
  }

 private:
  std::uint32_t pixel_;
  std::uint32_t index_;
};

}  // namespace msbvh
