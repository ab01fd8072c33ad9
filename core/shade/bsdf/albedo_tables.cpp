#include "core/shade/bsdf/albedo_tables.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/shade/bsdf/between.h"
#include "core/shade/bsdf/microfacet.h"

namespace msbvh {
namespace {

// Samples a cell along each axis.
constexpr int kSamples = 24;

LobeAlbedo blend(const LobeAlbedo& a, const LobeAlbedo& b, float weight) {
  return {a.straight + (b.straight - a.straight) * weight, a.grazing + (b.grazing - a.grazing) * weight};
}

// By visible normals, whose weight is the share of their light that gets out: smooth, so that a grid does.
LobeAlbedo integrated(float cosine, float alpha) {
  const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
  double straight = 0.0, grazing = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const Point2 random{(float(i) + 0.5f) / kSamples, (float(j) + 0.5f) / kSamples};
      const Vec3f normal = sample_visible_normal(out, alpha, random), in = mirrored(out, normal);
      if (in.z <= 0.0f) continue;
      const double weight = double(smith_visible(out, in, alpha)) / double(smith_visible(out, alpha));
      const double at_edge = schlick_weight(dot(out, normal));
      straight += weight * (1.0 - at_edge);
      grazing += weight * at_edge;
    }
  }
  constexpr double kCount = double(kSamples) * kSamples;
  return {float(straight / kCount), float(grazing / kCount)};
}

}  // namespace

AlbedoTables::AlbedoTables() : values_(kRoughnesses * kCosines), means_(kRoughnesses) {
  parallel_for(kRoughnesses, [this](std::size_t row) {
    const float alpha = alpha_of(float(row) / float(kRoughnesses - 1));
    LobeAlbedo* values = &values_[row * kCosines];
    for (std::size_t i = 0; i < kCosines; ++i) {
      const float root = std::max(1e-3f, float(i) / float(kCosines - 1));
      values[i] = integrated(root * root, alpha);
    }
    // 2 * integral of value * cosine, with cosine = root^2: 4 root^3 over the root.
    constexpr int kSteps = 512;
    double straight = 0.0, grazing = 0.0;
    for (int step = 0; step < kSteps; ++step) {
      const float root = (float(step) + 0.5f) / kSteps;
      const Between between(root, kCosines);
      const LobeAlbedo here = blend(values[between.index], values[between.index + 1], between.weight);
      const double weight = 4.0 * root * root * root / kSteps;
      straight += weight * here.straight;
      grazing += weight * here.grazing;
    }
    means_[row] = {float(straight), float(grazing)};
  });
}

const AlbedoTables& AlbedoTables::get() {
  static const AlbedoTables tables;
  return tables;
}

LobeAlbedo AlbedoTables::at(float cosine, float alpha) const {
  const Between row(std::sqrt(alpha), kRoughnesses), column(std::sqrt(std::max(0.0f, cosine)), kCosines);
  const LobeAlbedo* first = &values_[row.index * kCosines + column.index];
  return blend(blend(first[0], first[1], column.weight),
               blend(first[kCosines], first[kCosines + 1], column.weight), row.weight);
}

LobeAlbedo AlbedoTables::mean(float alpha) const {
  const Between row(std::sqrt(alpha), kRoughnesses);
  return blend(means_[row.index], means_[row.index + 1], row.weight);
}

}  // namespace msbvh
