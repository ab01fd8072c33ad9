// How much light a rough boundary between two transparent bodies lets go at once, reflected and refracted.
// The rest goes to and fro between its microfacets, and leaves as a lobe of its own on both sides, as of
// metals (albedo_tables.h; C. Kulla and A. Conty, SIGGRAPH 2017 course).
#pragma once

#include <cstddef>
#include <vector>

namespace msbvh {

class GlassTables {
 public:
  // Made at the first call, in some tenths of a second; thread-safe.
  static const GlassTables& get();

  // What is left behind of light that leaves (or comes) at an angle to the normal. `ratio`: ior of the far
  // side over that of the near one; beyond 3 and 1/3 as there.
  float missing(float cosine, float alpha, float ratio) const;
  // The mean over all directions on the near side, weighted by their cosine.
  float mean_missing(float alpha, float ratio) const;
  // Of that, what leaves on the near side, so that both ways have the same light but for the square of ratio.
  float reflected_share(float alpha, float ratio) const;

 private:
  GlassTables();

  static constexpr std::size_t kCosines = 24, kRoughnesses = 16, kRatios = 25;
  std::vector<float> values_;  // [ratio][roughness][root of the cosine]
  std::vector<float> means_;   // [ratio][roughness]
};

}  // namespace msbvh
