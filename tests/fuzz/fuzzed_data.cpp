#include "tests/fuzz/fuzzed_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace msbvh::fuzz {
namespace {

constexpr double kHostile[] = {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(),
                               1e300,
                               -1e300,
                               3.4e38,
                               1e30,
                               -1e30};
// What may be: the smallest and the largest that passes a gate, and what is next to round numbers.
constexpr double kExtreme[] = {0.0, -0.0, 1e-45, -1e-40, 1e-38, 1e-20, 0x1p60,      -0x1p60,
                               1e9, 1e7,  -1e5,  0x1p24, 0.5,   1.0,   0.99999994f, 1.0000001};

}  // namespace

std::uint64_t Stream::next() {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

FuzzedData::FuzzedData(const std::uint8_t* data, std::size_t size)
    : at_(data), end_(data + size), broken_(false), largest_(1e4) {
  const std::uint8_t first = byte();
  broken_ = (first & 3) == 3;
  if ((first & 12) == 12) largest_ = 0x1p60;
}

std::uint8_t FuzzedData::byte() { return at_ == end_ ? std::uint8_t(0) : *at_++; }

std::uint32_t FuzzedData::number32() {
  std::uint32_t number = 0;
  for (int i = 0; i < 4; ++i) number = number << 8 | byte();
  return number;
}

std::uint32_t FuzzedData::below(std::uint32_t count) {
  if (count == 0) return 0;
  return count <= 256 ? byte() % count : number32() % count;
}

double FuzzedData::unit() {
  const std::uint8_t b = byte();
  return b < 16 ? 0.0 : b < 32 ? 1.0 : b < 48 ? 0.5 : (double(b) - 47.0) / 209.0;
}

double FuzzedData::time01() {
  switch (below(8)) {
    case 6:
      return -unit();
    case 7:
      return real();
    default:
      return unit();
  }
}

double FuzzedData::real() {
  const std::uint8_t kind = byte();
  if (kind < 200) return double(std::int8_t(byte())) / 64.0;
  if (kind < 240 || !broken_) return std::clamp(kExtreme[byte() % std::size(kExtreme)], -largest_, largest_);
  return kHostile[byte() % std::size(kHostile)];
}

float FuzzedData::real32() { return float(std::clamp(real(), -3.4e38, 3.4e38)); }

// Below 2^-50 products of coordinates underflow, which the triangle test leaves out
// (docs/design/watertight.md).
double FuzzedData::size() {
  return std::min(0.5 * largest_, one_of({1.0, 1.0, 1.0, 1e-6, 1e3, 1e6, 1e-12, 0x1p59}));
}

double FuzzedData::positive() { return size() * (0.1 + unit()); }

std::vector<double> FuzzedData::times01(std::size_t count) {
  std::vector<double> times;
  double at = coin() ? 0.0 : -unit();
  for (std::size_t i = 0; i < count; ++i) {
    times.push_back(at);
    const double step = unit();
    at += step > 0.0 ? step * 0.5 : 1e-9;
  }
  if (!times.empty() && wrong()) times[below(std::uint32_t(count))] = real();
  return times;
}

std::vector<Vec3f> FuzzedData::points(std::size_t count) {
  Stream stream(number32());
  const double scale = size(), offset = rarely() ? size() : 0.0;
  const bool flat = rarely();
  std::vector<Vec3f> points(count);
  for (Vec3f& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = float(scale * (2.0 * stream.unit() - 1.0) + offset);
    if (flat) p.y = p.x;
  }
  for (std::uint32_t n = count == 0 || coin() ? 0 : below(4); n > 0; --n) {
    Vec3f& p = points[below(std::uint32_t(count))];
    p[int(below(3))] = real32();
  }
  if (count > 1 && rarely()) points[below(std::uint32_t(count))] = points[below(std::uint32_t(count))];
  return points;
}

std::vector<float> FuzzedData::reals(std::size_t count, float lo, float hi) {
  Stream stream(number32());
  std::vector<float> values(count);
  for (float& v : values) v = lo + (hi - lo) * float(stream.unit());
  if (count > 0 && coin()) {
    float& v = values[below(std::uint32_t(count))];
    v = broken_ ? real32() : (coin() ? lo : hi);
  }
  return values;
}

std::vector<std::uint32_t> FuzzedData::indices(std::size_t count, std::uint32_t below_count) {
  Stream stream(number32());
  std::vector<std::uint32_t> values(count);
  for (std::uint32_t& v : values) v = below_count == 0 ? 0 : std::uint32_t(stream.next() % below_count);
  if (count > 0 && wrong())
    values[below(std::uint32_t(count))] = one_of({below_count, 0xffffffffu, 0x80000000u});
  return values;
}

std::vector<int> FuzzedData::ints(std::size_t count, int lo, int hi) {
  Stream stream(number32());
  std::vector<int> values(count);
  for (int& v : values) v = lo + int(stream.next() % std::uint64_t(std::max(1, hi - lo + 1)));
  if (count > 0 && wrong()) {
    values[below(std::uint32_t(count))] =
        one_of({lo - 1, hi + 1, -1, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()});
  }
  return values;
}

Affine3f FuzzedData::map() {
  Affine3f map;
  const auto kind = below(6);
  if (kind == 0) return map;
  const float scale = kind == 1 ? real32() : kind == 2 ? float(size()) : 1.0f;
  const float angle = float(unit() * 6.3);
  map.x = {scale * std::cos(angle), scale * std::sin(angle), 0.0f};
  map.y = {-scale * std::sin(angle), scale * std::cos(angle), kind == 3 ? float(4.0 * unit() - 2.0) : 0.0f};
  map.z = {0.0f, 0.0f, kind == 4 ? 0.0f : scale};
  map.t = {real32(), real32(), real32()};
  if (kind == 5) map.y = map.x;  // of rank 2
  return map;
}

std::array<double, 16> FuzzedData::matrix() {
  const Affine3f m = map();
  std::array<double, 16> out{m.x.x, m.x.y, m.x.z, 0, m.y.x, m.y.y, m.y.z, 0,
                             m.z.x, m.z.y, m.z.z, 0, m.t.x, m.t.y, m.t.z, 1};
  if (rarely()) out[below(12)] = real();
  if (wrong()) out[below(16)] = real();
  return out;
}

std::string FuzzedData::word(std::initializer_list<const char*> words) {
  if (wrong()) return coin() ? "" : "garbage";
  return one_of(words);
}

}  // namespace msbvh::fuzz
