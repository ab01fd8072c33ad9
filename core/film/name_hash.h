// Hashes of names as Cryptomatte has them: MurmurHash3_32 with seed 0, as a float that is one.
//
// J. Friedman and A. C. Jones, "Cryptomatte: Fully automatic ID mattes with support for motion blur and
// transparency", SIGGRAPH Talks 2015, and its specification 1.2.0; A. Appleby's MurmurHash3, public domain.
#pragma once

#include <cstdint>
#include <string_view>

namespace msbvh {

std::uint32_t murmur3_32(std::string_view text);

// The bits of a float that is neither infinite, nor no number, nor denormal: a hash whose exponent would make
// it one gets another lowest bit of the exponent.
constexpr std::uint32_t float_bits_of_hash(std::uint32_t hash) {
  const std::uint32_t exponent = hash >> 23 & 255;
  return exponent == 0 || exponent == 255 ? hash ^ (1u << 23) : hash;
}

inline std::uint32_t name_hash(std::string_view name) { return float_bits_of_hash(murmur3_32(name)); }

}  // namespace msbvh
