// How much light the microfacet lobe reflects in all directions together, for a reflectance of 1: less than
// 1, since light that is reflected between microfacets is left out. What is missing is added as a lobe of its
// own, and what is not reflected at all is left for what lies below.
//
// C. Kulla and A. Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017 course.
#pragma once

#include <cstddef>
#include <vector>

namespace msbvh {

// Shares of the light that come back under Schlick's reflectance f0 + (f90 - f0) (1 - cos)^5:
// f0 * straight + f90 * grazing.
struct LobeAlbedo {
  float straight = 0.0f, grazing = 0.0f;
  float total() const { return straight + grazing; }  // for a reflectance of 1
};

class AlbedoTables {
 public:
  // Made at the first call, in some hundredths of a second; thread-safe.
  static const AlbedoTables& get();

  // For light that leaves (or comes) at an angle to the normal; `alpha` in [kLeastAlpha, 1].
  LobeAlbedo at(float cosine, float alpha) const;
  // The mean over all directions, weighted by their cosine.
  LobeAlbedo mean(float alpha) const;

 private:
  AlbedoTables();

  static constexpr std::size_t kCosines = 64, kRoughnesses = 32;
  std::vector<LobeAlbedo> values_;  // [roughness][root of the cosine]
  std::vector<LobeAlbedo> means_;   // [roughness]
};

}  // namespace msbvh
