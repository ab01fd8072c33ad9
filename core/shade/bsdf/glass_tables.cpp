#include "core/shade/bsdf/glass_tables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/shade/bsdf/between.h"
#include "core/shade/bsdf/glass.h"
#include "core/shade/bsdf/microfacet.h"

namespace msbvh {
namespace {

constexpr int kSamples = 16;  // a cell along each axis
constexpr float kMostRatio = 3.0f;

// What leaves at once: visible normals' shares that are not hidden on the way out.
float at_once(float cosine, float alpha, float ratio) {
  const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const Point2 random{(float(i) + 0.5f) / kSamples, (float(j) + 0.5f) / kSamples};
      const Vec3f facet = sample_visible_normal(out, alpha, random);
      const float near = dot(out, facet), seen = smith_visible(out, alpha);
      if (near <= 0.0f) continue;
      const float mirrored_share = fresnel_dielectric(near, ratio);
      const Vec3f up = mirrored(out, facet);
      if (up.z > 0.0f) sum += double(mirrored_share * smith_visible(out, up, alpha) / seen);
      if (mirrored_share >= 1.0f) continue;
      const Vec3f down = refracted(out, facet, ratio);
      if (down.z < 0.0f) sum += double((1.0f - mirrored_share) * smith_visible(out, down, alpha) / seen);
    }
  }
  return float(sum / (double(kSamples) * kSamples));
}

float place_of_ratio(float ratio) { return 0.5f + 0.5f * std::log(ratio) / std::log(kMostRatio); }

}  // namespace

GlassTables::GlassTables() : values_(kRatios * kRoughnesses * kCosines), means_(kRatios * kRoughnesses) {
  parallel_for(means_.size(), [this](std::size_t row) {
    const float place = float(row / kRoughnesses) / float(kRatios - 1);
    const float ratio = std::pow(kMostRatio, 2.0f * place - 1.0f);
    const float alpha = alpha_of(float(row % kRoughnesses) / float(kRoughnesses - 1));
    float* values = &values_[row * kCosines];
    for (std::size_t i = 0; i < kCosines; ++i) {
      const float root = std::max(1e-3f, float(i) / float(kCosines - 1));
      values[i] = std::clamp(1.0f - at_once(root * root, alpha, ratio), 0.0f, 1.0f);
    }
    // 2 * integral of value * cosine, with cosine = root^2: 4 root^3 over the root.
    constexpr int kSteps = 256;
    double mean = 0.0;
    for (int step = 0; step < kSteps; ++step) {
      const float root = (float(step) + 0.5f) / kSteps;
      const float value = Between(root, kCosines).of([&](std::size_t i) { return values[i]; });
      mean += 4.0 * double(root * root * root * value) / kSteps;
    }
    means_[row] = float(mean);
  });
}

const GlassTables& GlassTables::get() {
  static const GlassTables tables;
  return tables;
}

float GlassTables::missing(float cosine, float alpha, float ratio) const {
  const Between at_ratio(place_of_ratio(ratio), kRatios), row(std::sqrt(alpha), kRoughnesses),
      column(std::sqrt(std::max(0.0f, cosine)), kCosines);
  return at_ratio.of([&](std::size_t r) {
    return row.of([&](std::size_t a) {
      return column.of([&](std::size_t c) { return values_[(r * kRoughnesses + a) * kCosines + c]; });
    });
  });
}

float GlassTables::mean_missing(float alpha, float ratio) const {
  const Between at_ratio(place_of_ratio(ratio), kRatios), row(std::sqrt(alpha), kRoughnesses);
  return at_ratio.of(
      [&](std::size_t r) { return row.of([&](std::size_t a) { return means_[r * kRoughnesses + a]; }); });
}

// What goes through, one way and the other, has a ratio that is given. Of the way that lets more through that
// is Fresnel's mean, by the course's fit.
float GlassTables::reflected_share(float alpha, float ratio) const {
  const float denser = std::max(ratio, 1.0f / ratio);
  const float outer = mean_missing(alpha, denser), inner = mean_missing(alpha, 1.0f / denser);
  const float passes = 1.0f - (denser - 1.0f) / (4.08567f + 1.00071f * denser);
  if (!(outer > 0.0f) || !(inner > 0.0f)) return 1.0f;
  const float both = denser * denser * inner / outer;
  const float from_outside = passes * std::min(1.0f, both);
  return 1.0f - (ratio >= 1.0f ? from_outside : from_outside / both);
}

}  // namespace msbvh
