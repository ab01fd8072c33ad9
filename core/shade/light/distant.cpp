#include <cmath>
#include <limits>

#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// 1 - cos of the half angle: by its half, since the difference loses its digits for small angles.
float one_minus_cos(const PlacedLight& light) {
  const float sine_of_half = std::sin(light.values.angle_degrees * (kPi / 720.0f));
  return 2.0f * sine_of_half * sine_of_half;
}

}  // namespace

bool sample_distant(const PlacedLight& light, Point2 random, LightSample& sample) {
  const Vec3f axis = normalize(light.world_from_light.z);
  if (axis == Vec3f{}) return false;
  sample.distance = kInfinity;
  sample.direction = axis;
  sample.irradiance = light.values.radiance;
  sample.pdf = 0.0f;
  if (light.values.angle_degrees == 0.0f) return true;
  const float opening = one_minus_cos(light);
  sample.direction = normalize(Basis(axis)(sample_cone(random, opening)));
  sample.irradiance = light.values.radiance * (2.0f * kPi * opening);
  sample.pdf = 1.0f / (2.0f * kPi * opening);
  return true;
}

bool find_distant(const PlacedLight& light, const Vec3f& direction, LightAlong& along) {
  const Vec3f axis = normalize(light.world_from_light.z), apart = direction - axis;
  const float opening = one_minus_cos(light);
  // The chord's square is twice 1 - cos.
  if (axis == Vec3f{} || !(opening > 0.0f) || dot(apart, apart) > 2.0f * opening) return false;
  along = {light.values.radiance, kInfinity, 1.0f / (2.0f * kPi * opening)};
  return true;
}

}  // namespace msbvh
