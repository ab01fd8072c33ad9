#include <cmath>
#include <limits>

#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

// By its half, since the difference loses its digits for small angles.
float distant_opening(float angle_degrees) {
  const float sine_of_half = std::sin(angle_degrees * (kPi / 720.0f));
  return 2.0f * sine_of_half * sine_of_half;
}

template <bool kExtended>
bool sample_distant(const PlacedLight& light, Point2 random, LightSample& sample) {
  if (light.axis == Vec3f{}) return false;
  sample.distance = kInfinity;
  sample.direction = light.axis;
  sample.irradiance = light.values.radiance;
  sample.pdf = 0.0f;
  if (!kExtended || light.values.angle_degrees == 0.0f) return true;
  sample.direction = normalize(Basis(light.axis)(sample_cone(random, light.opening)));
  sample.irradiance = light.values.radiance * (2.0f * kPi * light.opening);
  sample.pdf = 1.0f / (2.0f * kPi * light.opening);
  return true;
}

template bool sample_distant<true>(const PlacedLight&, Point2, LightSample&);
template bool sample_distant<false>(const PlacedLight&, Point2, LightSample&);

bool find_distant(const PlacedLight& light, const Vec3f& direction, LightAlong& along) {
  const Vec3f apart = direction - light.axis;
  // The chord's square is twice 1 - cos.
  if (!(light.opening > 0.0f) || dot(apart, apart) > 2.0f * light.opening || light.axis == Vec3f{})
    return false;
  along = {light.values.radiance, kInfinity, 1.0f / (2.0f * kPi * light.opening)};
  return true;
}

}  // namespace msbvh
