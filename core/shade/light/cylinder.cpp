#include <algorithm>
#include <cmath>

#include "core/shade/light/flat.h"
#include "core/shade/light/shapes.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// Across the cylinder, in the light's space: lines from a point at the distance `off_axis` from the axis meet
// it at offsets of less than its radius. They are taken evenly, so that what is seen at a grazing angle is as
// likely as it is large. An affine map keeps what is in front of what.
struct Across {
  float radius, off_axis;

  // Inside: a cylinder light shines outwards.
  bool outside() const { return off_axis > radius && radius > 0.0f; }
  // The angle about the axis, from the point's own, at which the line of an offset first meets the cylinder.
  float angle(float offset) const { return std::asin(offset / radius) - std::asin(offset / off_axis); }
  // Its change over all offsets, if it changed everywhere as it does here.
  float angle_change(float offset) const {
    const float near = std::sqrt(std::max(radius * radius - offset * offset, 0.0f));
    const float far = std::sqrt(off_axis * off_axis - offset * offset);
    return 2.0f * radius * (far - near) / (far * near);
  }
};

Across across_from(const Vec3f& local, float radius) {
  return {radius, std::sqrt(local.y * local.y + local.z * local.z)};
}

// Inward normal at an angle, as long as the area over the density of its places.
Vec3f inward_area(const PlacedLight& light, float cosine, float sine, float angle_change) {
  const Affine3f& m = light.world_from_light;
  const Vec3f along = m.x * light.values.length;
  const Vec3f around = (m.z * cosine - m.y * sine) * (light.values.radius * angle_change);
  const Vec3f outward = m.y * cosine + m.z * sine, area = cross(along, around);
  return dot(area, outward) > 0.0f ? -area : area;  // a mirroring transform
}

}  // namespace

bool sample_cylinder(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample) {
  const float radius = light.values.radius;
  const Vec3f local = light.light_from_world.point(point);
  const Across across = across_from(local, radius);
  if (!across.outside()) return false;
  const float offset = (2.0f * random.y - 1.0f) * radius;
  const float angle = std::atan2(local.z, local.y) + across.angle(offset);
  const float cosine = std::cos(angle), sine = std::sin(angle);
  const Vec3f on_light =
      light.world_from_light.point({(random.x - 0.5f) * light.values.length, radius * cosine, radius * sine});
  return sample_area(light.values.radiance, inward_area(light, cosine, sine, across.angle_change(offset)),
                     on_light, point, sample);
}

bool find_cylinder(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along) {
  const Vec3f o = light.light_from_world.point(point), d = light.light_from_world.vector(direction);
  const float radius = light.values.radius;
  const Across across = across_from(o, radius);
  if (!across.outside()) return false;
  const float a = d.y * d.y + d.z * d.z, b = o.y * d.y + o.z * d.z;
  const float offset = (o.y * d.z - o.z * d.y) / std::sqrt(a);
  const float half_chord_squared = (radius * radius - offset * offset) * a;
  if (!(a > 0.0f && b < 0.0f && half_chord_squared >= 0.0f)) return false;
  const float distance = (-b - std::sqrt(half_chord_squared)) / a;
  if (!(distance > 0.0f) || !(std::abs(o.x + d.x * distance) <= 0.5f * light.values.length)) return false;
  const float cosine = (o.y + d.y * distance) / radius, sine = (o.z + d.z * distance) / radius;
  const float facing = dot(direction, inward_area(light, cosine, sine, across.angle_change(offset)));
  if (!(facing > 0.0f)) return false;
  along = {light.values.radiance, distance, distance * distance / facing};
  return true;
}

}  // namespace msbvh
