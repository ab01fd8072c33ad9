// Bytes of a fuzzer as values: mostly sound ones, with what breaks arithmetic among them.
//
// Past the end of the bytes everything is 0, so that each prefix of an input is an input. Arrays are
// generated from a seed of four bytes, then some of their elements are replaced: large structures take few
// bytes, and a fuzzer that changes one byte changes one thing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "core/base/vec.h"

namespace msbvh::fuzz {

class FuzzedData {
 public:
  // The first byte says whether anything may be wrong (broken()), and how large numbers are.
  FuzzedData(const std::uint8_t* data, std::size_t size);

  // Whether NaN, infinity, and sizes and counts that do not fit are among the values. Where not, every value
  // is one that a gate may let pass, so that what lies behind it is reached.
  bool broken() const { return broken_; }
  // Three of four inputs have numbers of the size of common scenes, which are cut to few triangles.
  double largest() const { return largest_; }

  std::uint8_t byte();
  std::uint32_t number32();
  std::uint32_t below(std::uint32_t count);  // 0 for no count
  bool coin() { return (byte() & 1) != 0; }
  bool rarely() { return (byte() & 15) == 15; }          // one of 16
  bool wrong() { return broken_ && (byte() & 7) == 7; }  // one of 8, where anything may be wrong
  template <typename T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[below(std::uint32_t(values.size()))];
  }

  double unit();      // [0, 1], the ends among them
  double time01();    // about the shutter, and far outside at times
  double real();      // -2 to 2 mostly; else of any size that is finite, or, broken(), none
  float real32();     // likewise, in single precision
  double positive();  // above 0, of any size
  std::vector<double> times01(std::size_t count);  // increasing, unless broken()
  // Of one of several sizes and offsets, some elements replaced by nasty ones.
  std::vector<Vec3f> points(std::size_t count);
  std::vector<float> reals(std::size_t count, float lo, float hi);
  std::vector<std::uint32_t> indices(std::size_t count, std::uint32_t below);  // broken(): or not
  std::vector<int> ints(std::size_t count, int lo, int hi);  // both included; broken(): or not
  Affine3f map();
  std::array<double, 16> matrix();                             // row vectors
  std::string word(std::initializer_list<const char*> words);  // or one that there is not

 private:
  double size();  // a power of ten

  const std::uint8_t* at_;
  const std::uint8_t* end_;
  bool broken_;
  double largest_;
};

// A generator for what a seed stands for: splitmix64.
class Stream {
 public:
  explicit Stream(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // [0, 1)

 private:
  std::uint64_t state_;
};

}  // namespace msbvh::fuzz
