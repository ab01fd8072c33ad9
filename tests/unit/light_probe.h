// Lights of each kind, and what they give a surface at the origin that faces +z.
#pragma once

#include <cmath>
#include <doctest/doctest.h>
#include <functional>
#include <memory>
#include <vector>

#include "core/integrate/sampler.h"
#include "core/shade/light/light.h"

namespace msbvh::light_probe {

inline constexpr std::uint32_t kSamples = 1u << 16;
inline constexpr double kPiD = 3.14159265358979323846;

inline Point2 random_pair(std::uint32_t i) {
  return Sampler(PixelSampler(3, i, 0), 0).pair(Dimension::kLight, 0);
}

inline Affine3f at(const Vec3f& position) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, position}; }

// Shines down at the origin from above.
inline Light light_of(LightKind kind, const Affine3f& world_from_light) {
  Light light;
  light.kind = kind;
  light.radiance = {3.0f, 1.0f, 0.5f};
  light.world_from_light = {world_from_light};
  return light;
}

inline std::shared_ptr<const LightImage> picture(ImageMap map, std::uint32_t width, std::uint32_t height,
                                                 const std::function<float(float u, float v)>& red) {
  std::vector<Vec3f> texels;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const float value = red((float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height));
      texels.push_back({value, 0.5f * value, 0.25f});
    }
  }
  return light_image("picture", map, width, height, std::move(texels));
}

inline float lumpy(float u, float v) {
  return 1.0f + 3.0f * u * u + (v < 0.3f ? 4.0f : 0.0f) + 0.5f * std::sin(9.0f * v);
}

// One of each kind that has an extent, large as seen from the origin and askew.
inline std::vector<Light> extended_lights() {
  const Affine3f askew{{1.2f, 0.3f, 0.1f}, {-0.2f, 0.9f, 0.4f}, {0.3f, -0.2f, 1.1f}, {0.4f, -0.3f, 1.5f}};
  std::vector<Light> lights;
  for (const LightKind kind : {LightKind::kDistant, LightKind::kSphere, LightKind::kRect, LightKind::kDisk}) {
    lights.push_back(light_of(kind, askew));
    lights.back().angle_degrees = 70.0f;
    lights.back().radius = 0.9f;
    lights.back().width = 2.0f;
    lights.back().height = 1.5f;
  }
  Light tube = light_of(LightKind::kCylinder, askew);
  tube.radius = 0.6f;
  tube.length = 2.5f;
  lights.push_back(tube);
  Light screen = lights[2];
  screen.image = picture(ImageMap::kRect, 7, 5, lumpy);
  lights.push_back(screen);
  for (const ImageMap map : {ImageMap::kLatlong, ImageMap::kAngular, ImageMap::kMirroredBall}) {
    Light dome = light_of(LightKind::kDome, {{0, 0.6f, 0.8f}, {1, 0, 0}, {0, 0.8f, -0.6f}, {}});
    dome.image = picture(map, 9, 8, lumpy);
    lights.push_back(dome);
  }
  return lights;
}

inline Vec3f on_sphere(double z, double angle) {
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {float(r * std::cos(angle)), float(r * std::sin(angle)), float(z)};
}

struct Estimate {
  double mean, sigma;
};

inline Estimate irradiance(const Light& light, float time = 0.0f) {
  double sum = 0, squares = 0;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    LightSample sample;
    double value = 0;
    if (sample_light(light, {}, {}, time, random_pair(i), sample))
      value = double(sample.irradiance.x) * std::max(0.0f, sample.direction.z);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kSamples;
  return {mean, std::sqrt(std::max(0.0, squares / kSamples - mean * mean) / kSamples)};
}

inline void check_irradiance(const Light& light, double expected, float time = 0.0f) {
  const Estimate found = irradiance(light, time);
  CAPTURE(found.mean);
  CAPTURE(expected);
  CHECK(std::abs(found.mean - expected) <= 4.5 * found.sigma + 1e-4 * std::abs(expected));
}

// By all directions, through find_light().
inline double gathered(const Light& light, float time = 0.0f) {
  constexpr int kRows = 600, kColumns = 1200;
  double sum = 0.0;
  for (int i = 0; i < kRows; ++i) {
    const double z = (i + 0.5) / kRows;
    for (int j = 0; j < kColumns; ++j) {
      LightAlong along;
      if (find_light(light, {}, on_sphere(z, 2 * kPiD * (j + 0.5) / kColumns), time, along))
        sum += z * along.radiance.x;
    }
  }
  return sum * 2 * kPiD / (double(kRows) * kColumns);
}

}  // namespace msbvh::light_probe
