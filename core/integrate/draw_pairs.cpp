#include "core/integrate/draw_pairs.h"

namespace msbvh {
namespace {

// Integers alone until the last step: the compiler makes vectors of it, and all instruction sets agree to the
// bit.
[[gnu::always_inline]] inline void draw_all(const std::uint32_t* pixels, const std::uint32_t* samples,
                                            std::size_t count, const Draw& draw, float* x, float* y) {
  for (std::size_t i = 0; i < count; ++i) {
    const Point2 p = Sampler(pixels[i], samples[i]).pair(draw);
    x[i] = p.x;
    y[i] = p.y;
  }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void draw_avx2(const std::uint32_t* pixels, const std::uint32_t* samples,
                                       std::size_t count, const Draw& draw, float* x, float* y) {
  draw_all(pixels, samples, count, draw, x, y);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

void draw_best(const std::uint32_t* pixels, const std::uint32_t* samples, std::size_t count, const Draw& draw,
               float* x, float* y) {
#if defined(__x86_64__)
  if (has_avx2()) return draw_avx2(pixels, samples, count, draw, x, y);
#endif
  draw_all(pixels, samples, count, draw, x, y);
}

}  // namespace

void DrawnPairs::draw(std::span<const Sampler> samplers, std::span<const std::uint32_t> paths,
                      const Draw& draw) {
  const std::size_t count = paths.size();
  if (count > x_.size()) {
    pixels_.resize(count);
    samples_.resize(count);
    x_.resize(count);
    y_.resize(count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    pixels_[i] = samplers[paths[i]].pixel();
    samples_[i] = samplers[paths[i]].sample();
  }
  draw_best(pixels_.data(), samples_.data(), count, draw, x_.data(), y_.data());
}

}  // namespace msbvh
