#include <algorithm>
#include <limits>

#include "core/shade/light/image.h"
#include "core/shade/light/portal.h"
#include "core/shade/light/shapes.h"

namespace msbvh {
namespace {

float solid_angle(const LightImage& image, float u, float v) {
  return std::max(0.0f, static_cast<float>(image_solid_angle(image.map, double(u), double(v))));
}

}  // namespace

Affine3f dome_rotation(const Affine3f& m) {
  const Vec3f y = normalize(m.y), z = normalize(m.z - y * dot(m.z, y)), x = cross(y, z);
  return {dot(x, m.x) < 0.0f ? -x : x, y, z, {}};
}

namespace {

// Half of the samples go through the portals, and all of them have the density of both ways together.
bool sample_guided(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  LightAlong along;
  if (random.x < kPortalShare) {
    random.x = std::min(random.x / kPortalShare, 0x1.fffffep-1f);
    if (!sample_portal(light, point, random, sample.direction)) return false;
  } else {
    random.x = std::min((random.x - kPortalShare) / (1.0f - kPortalShare), 0x1.fffffep-1f);
    const ImagePlace place = sample_image(*light.source->image, random);
    const Vec3f own = image_direction(light.source->image->map, place.u, place.v);
    sample.direction = normalize(light.world_from_light.vector(own));
  }
  if (!find_dome(light, point, sample.direction, along) || !(along.pdf > 0.0f)) return false;
  sample.pdf = along.pdf;
  sample.distance = along.distance;
  sample.irradiance = along.radiance * (1.0f / along.pdf);
  return true;
}

bool is_guided(const PlacedLight& light, const Vec3f& point) {
  return !light.source->portals.empty() && any_portal(light, point);
}

}  // namespace

bool sample_dome(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  if (is_guided(light, point)) return sample_guided(light, point, random, sample);
  const LightImage& image = *light.source->image;
  const ImagePlace place = sample_image(image, random);
  const float angle = solid_angle(image, place.u, place.v);
  if (!(angle > 0.0f && place.density > 0.0f)) return false;  // beyond a disc's rim
  sample.pdf = place.density / angle;
  sample.distance = std::numeric_limits<float>::infinity();
  sample.direction = normalize(light.world_from_light.vector(image_direction(image.map, place.u, place.v)));
  sample.irradiance = light.values.radiance * image_at(image, place.u, place.v) * (1.0f / sample.pdf);
  return true;
}

bool find_dome(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  const LightImage& image = *light.source->image;
  const Affine3f& m = light.world_from_light;
  const Point2 place =
      image_place(image.map, {dot(direction, m.x), dot(direction, m.y), dot(direction, m.z)});
  const float angle = solid_angle(image, place.x, place.y);
  along = {light.values.radiance * image_at(image, place.x, place.y), std::numeric_limits<float>::infinity(),
           image_density(image, place.x, place.y) / angle};
  if (is_guided(light, point))
    along.pdf = kPortalShare * portal_pdf(light, point, direction) + (1.0f - kPortalShare) * along.pdf;
  return true;
}

}  // namespace msbvh
