// Owen-scrambled Sobol' points: one three-dimensional sequence for time and place in the pixel, and
// two-dimensional ones for all else, each under a name.
//
// B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020. Sampling is progressive: the number of
// samples enters nowhere, and the first n of them are well distributed for every n, best where n is a power
// of two. More samples can so be added to a picture, and samples can be taken apart into blocks, without
// another noise. Nothing depends on the order in which a path draws, so that switching an effect off does not
// change the noise of the rest.
//
// Place and time are the first three Sobol' dimensions (S. Joe and F. Kuo, "Constructing Sobol Sequences with
// Better Two-Dimensional Projections", SIAM J. Sci. Comput. 30, 2008), scrambled apart in each pixel but not
// shuffled: of 2^m samples from a multiple of 2^m on, each is in a time stratum of its own of 2^m. The pairs
// are shuffled against them and each other.
#pragma once

#include <array>
#include <cstdint>

#include "core/shade/point2.h"

namespace msbvh {

// How samples are spread.
enum class Sampling : std::uint8_t {
  kSobol,       // well apart, for every number of them
  kIndependent  // each by itself at random: noisier, for comparisons
};

struct SamplingName {
  Sampling sampling;
  const char* name;
};
inline constexpr SamplingName kSamplings[] = {{Sampling::kSobol, "sobol"},
                                              {Sampling::kIndependent, "independent"}};

enum class Dimension : std::uint32_t {
  kCamera,     // place in the pixel, and time
  kOpacity,    // whether a surface is seen or seen through
  kLightPick,  // which of many lights
  kLight,      // point on a light
  kBounce,     // direction of the next ray
  kLens,       // point on the lens
  kLobe        // which of a surface's lobes a ray is scattered by
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

// The reversed direction numbers of the third dimension: primitive polynomial x^2 + x + 1, m = 1, 3.
constexpr std::array<std::uint32_t, 32> third_directions() {
  std::array<std::uint32_t, 32> m{1, 3};
  for (std::size_t k = 2; k < 32; ++k) m[k] = (m[k - 1] << 1) ^ (m[k - 2] << 2) ^ m[k - 2];
  for (std::size_t k = 0; k < 32; ++k) m[k] = reverse_bits(m[k] << (31 - k));
  return m;
}

// Sums of those, for each value of each four bits of an index.
constexpr std::array<std::array<std::uint32_t, 16>, 8> third_sums() {
  constexpr std::array<std::uint32_t, 32> kDirections = third_directions();
  std::array<std::array<std::uint32_t, 16>, 8> sums{};
  for (std::size_t i = 0; i < 32; ++i) {
    for (std::size_t value = 0; value < 16; ++value) {
      if (value >> (i % 4) & 1) sums[i / 4][value] ^= kDirections[i];
    }
  }
  return sums;
}

inline constexpr std::array<std::array<std::uint32_t, 16>, 8> kThirdSums = third_sums();

// The third Sobol' dimension with its bits reversed.
constexpr std::uint32_t third(std::uint32_t index) {
  std::uint32_t result = 0;
  for (std::size_t four = 0; index != 0; ++four, index >>= 4) result ^= kThirdSums[four][index & 15];
  return result;
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

// A coordinate from its reversed bits.
constexpr float scrambled(std::uint32_t reversed, std::uint32_t seed) {
  return to_unit_float(reverse_bits(scramble_reversed(reversed, seed)));
}

// Point `index` of the two-dimensional sequence, both dimensions scrambled.
constexpr Point2 point(std::uint32_t index, std::uint32_t seed_x, std::uint32_t seed_y) {
  return {scrambled(index, seed_x), scrambled(pascal(index), seed_y)};
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

// One pixel's scrambles; sample after sample may be drawn from it.
class PixelSampler {
 public:
  constexpr PixelSampler(std::uint32_t seed, std::uint32_t pixel_x, std::uint32_t pixel_y)
      : pixel_(hash(hash(hash(seed), pixel_x), pixel_y)),
        x_(hash(camera_key(), 0)),
        y_(hash(camera_key(), 1)),
        time_(hash(camera_key(), 2)) {}

  constexpr std::uint32_t key() const { return pixel_; }
  constexpr Point2 position(std::uint32_t sample) const { return sobol::point(sample, x_, y_); }
  constexpr float time(std::uint32_t sample) const { return sobol::scrambled(sobol::third(sample), time_); }

 private:
  constexpr std::uint32_t camera_key() const {
    return hash(pixel_, static_cast<std::uint32_t>(Dimension::kCamera));
  }

  std::uint32_t pixel_, x_, y_, time_;
};

// Which of the sequence's points a sample takes. Points of indices at random know nothing of each other.
template <Sampling kSampling>
constexpr std::uint32_t sequence_index(const PixelSampler& pixel, std::uint32_t sample) {
  return kSampling == Sampling::kSobol ? sample : hash(~pixel.key(), sample);
}

// What a pair is drawn for: the same for all paths of a batch, so made once for them. `depth` counts the
// vertices of the path, `which` the lights or layers at one of them.
class Draw {
 public:
  constexpr Draw(Dimension dimension, std::uint32_t depth, std::uint32_t which = 0)
      : key_(hash(hash(hash(static_cast<std::uint32_t>(dimension)), depth), which)) {}
  constexpr std::uint32_t key() const { return key_; }

 private:
  std::uint32_t key_;
};

// One sample of one pixel. Cheap to make.
class Sampler {
 public:
  constexpr Sampler() = default;
  constexpr Sampler(const PixelSampler& pixel, std::uint32_t sample) : Sampler(pixel.key(), sample) {}
  constexpr Sampler(std::uint32_t pixel_key, std::uint32_t sample) : pixel_(pixel_key), sample_(sample) {}

  constexpr std::uint32_t pixel() const { return pixel_; }  // PixelSampler::key()
  constexpr std::uint32_t sample() const { return sample_; }

  constexpr Point2 pair(const Draw& draw) const {
    const std::uint32_t key = hash(pixel_ ^ draw.key());
    return sobol::point(sobol::shuffle(sample_, key), hash(key, 0), hash(key, 1));
  }
  constexpr Point2 pair(Dimension dimension, std::uint32_t depth, std::uint32_t which = 0) const {
    return pair(Draw(dimension, depth, which));
  }

 private:
  std::uint32_t pixel_ = 0;
  std::uint32_t sample_ = 0;
};

}  // namespace msbvh
