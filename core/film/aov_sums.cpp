#include "core/film/aov_sums.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

namespace msbvh {
namespace {

void put(const Vec3f& v, float* out) {
  for (int c = 0; c < 3; ++c) out[c] = v[c];
}
Aov crypto_aov(std::size_t kind) {
  return static_cast<Aov>(static_cast<std::size_t>(Aov::kCryptoObject) + kind);
}
void put(std::span<const float> numbers, float* out) { std::ranges::copy(numbers, out); }

}  // namespace

void CoverageSum::add(std::uint32_t name) {
  const auto known = std::ranges::find(found_, name, &Coverage::name);
  if (known != found_.end()) {
    ++known->samples;
  } else {
    found_.push_back({name, 1});
  }
}

void CoverageSum::resolve(std::uint32_t count, float* out) const {
  std::vector<Coverage> ranked = found_;
  std::ranges::sort(ranked, [](const Coverage& a, const Coverage& b) {
    return a.samples != b.samples ? a.samples > b.samples : a.name < b.name;
  });
  ranked.resize(kCryptoRanks, {0, 0});
  for (const Coverage& each : ranked) {
    *out++ = std::bit_cast<float>(each.name);
    *out++ = static_cast<float>(each.samples) / static_cast<float>(count);
  }
}

double MomentSum::error(std::uint32_t count) const {
  if (count < 2) return 0.0;
  const double n = count, mean = sum / n;
  return std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1.0));
}

void AovTotals::expose(double factor) {
  for (Vec3d* part :
       {&light.emission, &light.direct, &light.direct_specular, &light.indirect, &light.indirect_specular})
    *part = *part * factor;
  moments.sum *= factor;
  moments.squares *= factor * factor;
}

void AovTotals::resolve(Aov aov, float* out) const {
  const auto mean = [&](const Vec3d& sum) { put(Vec3f(sum * (1.0 / count)), out); };
  const AovSample& nearest = seen.nearest;
  switch (aov) {
    case Aov::kDepth:
      *out = nearest.depth;
      return;
    case Aov::kCameraDepth:
      *out = nearest.camera_depth;
      return;
    case Aov::kNeye:
      return mean(seen.eye_normal);
    case Aov::kNormal:
      return mean(seen.normal);
    case Aov::kAlbedo:
      return mean(seen.albedo);
    case Aov::kPeye:
      return put(nearest.eye_position, out);
    case Aov::kPworld:
      return put(nearest.position, out);
    case Aov::kSt:
      return put(nearest.st, out);
    case Aov::kForward:
      return put(nearest.forward, out);
    case Aov::kBackward:
      return put(nearest.backward, out);
    case Aov::kMotionCurve:
      return put(nearest.motion_curve, out);
    case Aov::kSampleCount:
      *out = static_cast<float>(count);
      return;
    case Aov::kNoise:
      *out = static_cast<float>(moments.error(count));
      return;
    case Aov::kNodeVisits:
      *out = static_cast<float>(cost.nodes / count);
      return;
    case Aov::kPrimitiveTests:
      *out = static_cast<float>(cost.primitives / count);
      return;
    case Aov::kSeconds:
      *out = static_cast<float>(seconds);
      return;
    case Aov::kDirectDiffuse:
      return mean(light.direct - light.direct_specular);
    case Aov::kDirectSpecular:
      return mean(light.direct_specular);
    case Aov::kIndirectDiffuse:
      return mean(light.indirect - light.indirect_specular);
    case Aov::kIndirectSpecular:
      return mean(light.indirect_specular);
    case Aov::kEmission:
      return mean(light.emission);
    case Aov::kCryptoObject:
    case Aov::kCryptoMaterial:
    case Aov::kCryptoInstance:
      return coverage[crypto_kind(aov)]->resolve(count, out);
    case Aov::kPrimId:
    case Aov::kInstanceId:
    case Aov::kElementId:
      return;
  }
}

std::int32_t AovTotals::id(Aov aov) const {
  const AovSample& nearest = seen.nearest;
  if (aov == Aov::kPrimId) return nearest.prim;
  return aov == Aov::kInstanceId ? nearest.instance : nearest.element;
}

void AovSums::reset(const AovSet& asked, std::size_t pixels) {
  asked_ = asked;
  seen_.reset(pixels);
  light_.reset(asked.light() ? pixels : 0);
  cost_.reset(asked.cost() ? pixels : 0);
  moments_.reset(asked.has(Aov::kNoise) ? pixels : 0);
  for (std::size_t kind = 0; kind < kCryptoKinds; ++kind) {
    if (!asked.has(crypto_aov(kind))) continue;
    coverage_[kind].resize(std::max(coverage_[kind].size(), pixels));
    for (CoverageSum& sum : coverage_[kind]) sum.clear();
  }
}

void AovSums::add(std::size_t pixel, const CryptoSample& names) {
  for (std::size_t kind = 0; kind < kCryptoKinds; ++kind) {
    if (names[kind] != 0 && asked_.has(crypto_aov(kind))) coverage_[kind][pixel].add(names[kind]);
  }
}

void AovSums::end_sample() {
  seen_.end_sample();
  light_.end_sample();
  cost_.end_sample();
  moments_.end_sample();
}

void AovSums::trim() {
  seen_.trim();
  light_.trim();
  cost_.trim();
  moments_.trim();
}

AovTotals AovSums::total(std::size_t pixel) const {
  AovTotals totals;
  totals.count = seen_.count();
  totals.seen = seen_.total(pixel);
  if (asked_.light()) totals.light = light_.total(pixel);
  if (asked_.cost()) totals.cost = cost_.total(pixel);
  if (asked_.has(Aov::kNoise)) totals.moments = moments_.total(pixel);
  for (std::size_t kind = 0; kind < kCryptoKinds; ++kind) {
    if (asked_.has(crypto_aov(kind))) totals.coverage[kind] = &coverage_[kind][pixel];
  }
  return totals;
}

}  // namespace msbvh
