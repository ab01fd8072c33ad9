// The noise of a pixel that a bar sweeps, by ways to sample its place and time: a table in Markdown.
//
// A bar of random width and direction moves evenly over the pixel while the shutter is open. The variance of
// the mean of n samples is over many such pixels, against the mean of 4096 samples of another pixel's
// sequence.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "core/integrate/path_batch.h"
#include "core/integrate/sampler.h"

namespace msbvh {
namespace {

constexpr int kPixels = 20000;
constexpr std::uint32_t kConverged = 4096, kOtherPixel = 1u << 20;

struct Place {
  float time, x, y;  // in the shutter and in the pixel, [0, 1)
};

class Bar {
 public:
  Bar(float speed, std::mt19937& random) : speed_(speed) {
    std::uniform_real_distribution<float> uniform;
    const float angle = 2.0f * std::numbers::pi_v<float> * uniform(random);
    x_ = std::cos(angle);
    y_ = std::sin(angle);
    width_ = 0.3f + 2.0f * uniform(random);
    start_ = uniform(random) * (speed + 2.0f + width_) - speed - 1.0f - width_;
  }
  double seen(const Place& p) const {
    const float along = (p.x - 0.5f) * x_ + (p.y - 0.5f) * y_ - start_ - speed_ * p.time;
    return along > 0.0f && along < width_ ? 1.0 : 0.0;
  }

 private:
  float speed_, x_, y_, width_, start_;
};

Place ours(std::uint32_t pixel, std::uint32_t sample) {
  const PixelSampler sampler(1, pixel, 0);
  const Point2 p = sampler.position(sample);
  return {sampler.time(sample), p.x, p.y};
}

struct Variances {
  double independent = 0, stratified = 0, ours = 0;
};

Variances variances(float speed, std::uint32_t samples) {
  std::mt19937 random(samples);
  std::uniform_real_distribution<float> uniform;
  Variances sum;
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    const Bar bar(speed, random);
    double truth = 0, independent = 0, stratified = 0, progressive = 0;
    for (std::uint32_t s = 0; s < kConverged; ++s)
      truth += bar.seen(ours(pixel + kOtherPixel, s)) / kConverged;
    for (std::uint32_t s = 0; s < samples; ++s) {
      independent += bar.seen({uniform(random), uniform(random), uniform(random)}) / samples;
      const float stratum = (static_cast<float>(s) + uniform(random)) / static_cast<float>(samples);
      stratified += bar.seen({stratum, uniform(random), uniform(random)}) / samples;
      progressive += bar.seen(ours(pixel, s)) / samples;
    }
    const auto add = [&](double& variance, double mean) {
      variance += (mean - truth) * (mean - truth) / kPixels;
    };
    add(sum.independent, independent);
    add(sum.stratified, stratified);
    add(sum.ours, progressive);
  }
  return sum;
}

void print_table() {
  std::printf("| pixels a shutter | samples | random | random in time strata | ours | strata / ours |\n");
  std::printf("|---|---|---|---|---|---|\n");
  for (const float speed : {0.0f, 3.0f, 20.0f}) {
    for (const std::uint32_t samples : {3u, 4u, 16u, 24u, 64u, 256u}) {
      const Variances v = variances(speed, samples);
      std::printf("| %g | %u | %.2e | %.2e | %.2e | %.1f |\n", double(speed), samples, v.independent,
                  v.stratified, v.ours, v.stratified / v.ours);
    }
  }
  std::printf("\nA batch of %zu paths takes %zu bytes a path, %.1f MB a thread; with AOVs %zu bytes.\n",
              kMaxBatchPaths, kBytesAPath, double(kMaxBatchPaths * kBytesAPath) * 1e-6,
              kBytesAPath + sizeof(AovSample));
}

}  // namespace
}  // namespace msbvh

int main() { msbvh::print_table(); }
