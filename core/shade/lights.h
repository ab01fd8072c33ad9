// Sampling of the lights that have a direction: all but the dome, which bounces gather.
#pragma once

#include <vector>

#include "core/scene/scene.h"
#include "core/shade/point2.h"

namespace msbvh {

// A direction to a light from a point. The expectation of `irradiance` * cos(theta), over the samples, is the
// irradiance of a surface whose normal is at the angle theta to `direction`.
struct LightSample {
  Vec3f direction;   // unit, in the world
  float distance;    // to the light along it; infinite for a distant light
  Vec3f irradiance;  // at normal incidence: radiance over the density of the direction
  bool casts_shadow = true;
};

// False where the light does not shine on `point` from the sampled direction. Not for domes.
bool sample_light(const Light& light, const Camera& camera, const Vec3f& point, float time, Point2 random,
                  LightSample& sample);

// The scene's lights as an integrator wants them.
class LightSet {
 public:
  explicit LightSet(const Scene& scene);

  // The sum of all domes at a time; zero without.
  Vec3f dome_radiance(float time) const {
    return moving_domes_.empty() ? still_dome_radiance_ : moving_dome_radiance(time);
  }

  std::vector<const Light*> sampled;
  bool has_dome = false;

 private:
  Vec3f moving_dome_radiance(float time) const;

  Vec3f still_dome_radiance_;
  std::vector<const Light*> moving_domes_;
};

}  // namespace msbvh
