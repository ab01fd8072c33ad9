// AOVs of one sample, and the sums of many: core/film/aov.h. What is added together lies together.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/vec.h"
#include "core/film/aov.h"
#include "core/film/film_sample.h"
#include "core/film/sum_tree.h"

namespace msbvh {

// What one sample saw first. As constructed: nothing.
struct AovSample {
  float camera_depth = std::numeric_limits<float>::infinity();
  float depth = 1.0f;
  std::int32_t prim = -1, instance = -1, element = -1;
  Vec3f eye_normal, normal, albedo;
  // Where they are asked for.
  Vec3f eye_position, position;
  std::array<float, 2> st{}, forward{}, backward{};
  std::array<float, 8> motion_curve{};
};

// Over many samples, in any order of blocks: the nearest is the nearest whoever compares first.
struct AovSum {
  AovSample nearest;
  std::uint32_t number = 0xffffffffu;  // of the nearest sample
  Vec3d eye_normal, normal, albedo;

  void add(const AovSample& sample, std::uint32_t sample_number) {
    AovSum one;
    one.nearest = sample;
    one.number = sample_number;
    one.eye_normal = Vec3d(sample.eye_normal);
    one.normal = Vec3d(sample.normal);
    one.albedo = Vec3d(sample.albedo);
    *this += one;
  }
  AovSum& operator+=(const AovSum& b) {
    const float own = nearest.camera_depth, other = b.nearest.camera_depth;
    if (other < own || (other == own && b.number < number)) {
      nearest = b.nearest;
      number = b.number;
    }
    eye_normal += b.eye_normal;
    normal += b.normal;
    albedo += b.albedo;
    return *this;
  }
};

// Ways of light to the camera.
enum class LightPath : std::uint8_t { kEmission, kDirect, kIndirect };

// Radiance by its way, and of it what the first surface's specular lobes reflected.
template <typename T>
struct LightParts {
  Vec3<T> emission, direct, direct_specular, indirect, indirect_specular;

  template <typename U>
  LightParts& operator+=(const LightParts<U>& b) {
    emission += Vec3<T>(b.emission);
    direct += Vec3<T>(b.direct);
    direct_specular += Vec3<T>(b.direct_specular);
    indirect += Vec3<T>(b.indirect);
    indirect_specular += Vec3<T>(b.indirect_specular);
    return *this;
  }
  void add(LightPath way, const Vec3<T>& all, const Vec3<T>& specular) {
    if (way == LightPath::kEmission) {
      emission += all;
      return;
    }
    (way == LightPath::kDirect ? direct : indirect) += all;
    (way == LightPath::kDirect ? direct_specular : indirect_specular) += specular;
  }
};

// What a sample's camera ray met in the tree.
struct CostSum {
  double nodes = 0.0, primitives = 0.0;

  CostSum& operator+=(const CostSum& b) {
    nodes += b.nodes;
    primitives += b.primitives;
    return *this;
  }
};

// Of luminance, for how far it spreads.
struct MomentSum {
  double sum = 0.0, squares = 0.0;

  MomentSum& operator+=(const MomentSum& b) {
    sum += b.sum;
    squares += b.squares;
    return *this;
  }
  void add(const Vec3f& radiance) {
    const double luminance = 0.2126 * radiance.x + 0.7152 * radiance.y + 0.0722 * radiance.z;
    *this += MomentSum{luminance, luminance * luminance};
  }
  // Standard error of the mean of `count` independent samples; 0 of one, which says nothing.
  double error(std::uint32_t count) const;
};

// By the place of an AOV among kCryptoObject, kCryptoMaterial and kCryptoInstance.
inline constexpr std::size_t kCryptoKinds = 3;
constexpr std::size_t crypto_kind(Aov aov) {
  return static_cast<std::size_t>(aov) - static_cast<std::size_t>(Aov::kCryptoObject);
}
// Hashes of the names of what a sample saw first (core/film/name_hash.h); 0: nothing.
using CryptoSample = std::array<std::uint32_t, kCryptoKinds>;

// How many samples saw each name; whole numbers, so that no order of samples matters.
struct Coverage {
  std::uint32_t name, samples;
};
class CoverageSum {
 public:
  void clear() { found_.clear(); }
  void add(std::uint32_t name);
  // Names, as the bits of floats, and their shares of `count` samples: the largest first, of equals the least
  // name; kCryptoRanks pairs, 0 where there are fewer.
  void resolve(std::uint32_t count, float* out) const;

 private:
  std::vector<Coverage> found_;
};

// All of a pixel.
struct AovTotals {
  std::uint32_t count = 0;  // samples
  AovSum seen;
  LightParts<double> light;
  CostSum cost;
  MomentSum moments;
  double seconds = 0.0;
  std::array<const CoverageSum*, kCryptoKinds> coverage{};  // where asked for

  // As if all light had been so many times as bright.
  void expose(double factor);
  // form_of(aov).numbers numbers. Not for ids.
  void resolve(Aov aov, float* out) const;
  std::int32_t id(Aov aov) const;
};

// Of a tile's pixels. Groups that are not asked for hold nothing.
class AovSums {
 public:
  // `asked`: empty where no AOV is.
  void reset(const AovSet& asked, std::size_t pixels);
  const AovSet& asked() const { return asked_; }

  // Of the sample at hand; end_sample() follows.
  void add(std::size_t pixel, std::uint32_t number, const AovSample& seen) {
    seen_.open(pixel).add(seen, number);
  }
  void add(std::size_t pixel, const LightParts<float>& light) { light_.open(pixel) += light; }
  void add(std::size_t pixel, const CostSum& cost) { cost_.open(pixel) += cost; }
  void add(std::size_t pixel, const Vec3f& radiance) { moments_.open(pixel).add(radiance); }
  void add(std::size_t pixel, const CryptoSample& names);
  void end_sample();

  AovTotals total(std::size_t pixel) const;
  void trim();  // as SumTrees'

 private:
  AovSet asked_;
  SumTrees<AovSum> seen_;
  SumTrees<LightParts<double>> light_;
  SumTrees<CostSum> cost_;
  SumTrees<MomentSum> moments_;
  std::array<std::vector<CoverageSum>, kCryptoKinds> coverage_;
};

}  // namespace msbvh
