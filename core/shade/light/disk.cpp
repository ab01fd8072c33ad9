#include "core/shade/light/flat.h"
#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {

Vec3f dark_disk_area(float radius, const Affine3f& m) {
  const Vec3f area = cross(m.x * radius, m.y * radius) * kPi;
  return dot(area, m.z) < 0.0f ? -area : area;  // a mirroring transform
}

bool sample_disk(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  const Point2 place = sample_disc(random);
  const float radius = light.values.radius;
  const Vec3f on_light = light.world_from_light.point({place.x * radius, place.y * radius, 0.0f});
  return sample_area(light.values.radiance, light.dark_area, on_light, point, sample);
}

bool find_disk(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  const Affine3f& m = light.world_from_light;
  const float radius = light.values.radius;
  FlatPlace place;
  if (!find_flat(m.t, m.x * radius, m.y * radius, light.dark_area, point, direction, place)) return false;
  const float u = place.u / place.scale, v = place.v / place.scale;
  if (!(u * u + v * v <= 1.0f)) return false;
  along = {light.values.radiance, place.distance, place.pdf};
  return true;
}

}  // namespace msbvh
