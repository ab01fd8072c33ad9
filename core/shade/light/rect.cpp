#include <algorithm>
#include <cmath>

#include "core/shade/light/flat.h"
#include "core/shade/light/image.h"
#include "core/shade/light/shapes.h"

namespace msbvh {

Vec3f dark_area(const LightValues& values, const Affine3f& m) {
  const Vec3f area = cross(m.x * values.width, m.y * values.height);
  return dot(area, m.z) < 0.0f ? -area : area;  // a mirroring transform
}

bool sample_rect(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  const LightValues& values = light.values;
  const Vec3f on_light = light.world_from_light.point(
      {(random.x - 0.5f) * values.width, (random.y - 0.5f) * values.height, 0.0f});
  return sample_area(values.radiance, light.dark_area, on_light, point, sample);
}

bool sample_image_rect(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  const LightValues& values = light.values;
  const LightImage& image = *light.source->image;
  const ImagePlace place = sample_image(image, random);
  if (!(place.density > 0.0f)) return false;
  const Vec3f on_light =
      light.world_from_light.point({(0.5f - place.u) * values.width, (0.5f - place.v) * values.height, 0.0f});
  return sample_area(values.radiance * image_at(image, place.u, place.v),
                     light.dark_area * (1.0f / place.density), on_light, point, sample);
}

bool find_rect(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  const Affine3f& m = light.world_from_light;
  FlatPlace place;
  if (!find_flat(m.t, m.x * light.values.width, m.y * light.values.height, light.dark_area, point, direction,
                 place))
    return false;
  const float half = 0.5f * place.scale;
  if (std::abs(place.u) > half || std::abs(place.v) > half) return false;
  along = {light.values.radiance, place.distance, place.pdf};
  return true;
}

bool find_image_rect(const PlacedLight& light, const Vec3f& point, const Vec3f& direction,
                     LightAlong& along) {
  const Affine3f& m = light.world_from_light;
  FlatPlace place;
  if (!find_rect(light, point, direction, along) ||
      !find_flat(m.t, m.x * light.values.width, m.y * light.values.height, light.dark_area, point, direction,
                 place))
    return false;
  const LightImage& image = *light.source->image;
  const float u = std::clamp(0.5f - place.u / place.scale, 0.0f, 1.0f);
  const float v = std::clamp(0.5f - place.v / place.scale, 0.0f, 1.0f);
  along.radiance = along.radiance * image_at(image, u, v);
  along.pdf *= image_density(image, u, v);
  return true;
}

}  // namespace msbvh
