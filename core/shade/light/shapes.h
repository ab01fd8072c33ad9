// Lights by their kinds, each where it is and as it shines at one time. See light.h.
#pragma once

#include "core/shade/light/light.h"

namespace msbvh {

// A disc of directions about the light's +z axis. Without an extent, radiance stands for irradiance, since
// UsdLux's normalisation divides by nothing there. kExtended, here and below: false where none has an extent.
template <bool kExtended>
bool sample_distant(const PlacedLight& light, Point2 random, LightSample& sample);
bool find_distant(const PlacedLight& light, const Vec3f& direction, LightAlong& along);
// 1 - cos of the half angle.
float distant_opening(float angle_degrees);

// Uniform in the cone that the sphere subtends (pbrt-v4, section 6.2.4), to the near side of the sphere.
template <bool kExtended>
bool sample_sphere(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample);
bool find_sphere(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along);
// UsdLux has no ellipsoids: a sphere under a transform that is not a similarity takes the radius of equal
// volume.
float world_radius(float radius, const Affine3f& world_from_light);

// Uniform by area on the parallelogram that the transform makes of the rectangle.
bool sample_rect(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample);
bool find_rect(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along);
Vec3f dark_area(const LightValues& values, const Affine3f& world_from_light);
// By what its image gives.
bool sample_image_rect(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample);
bool find_image_rect(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along);

// Uniform by area on the ellipse that the transform makes of the disk.
bool sample_disk(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample);
bool find_disk(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along);
Vec3f dark_disk_area(float radius, const Affine3f& world_from_light);

// Uniform along the cylinder and across it as the point sees it; under any transform.
bool sample_cylinder(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample);
bool find_cylinder(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along);

// By what its image gives over the sphere of directions and, where it has portals, through them. The
// transform counts as the rotation, or the mirror, that keeps its y axis.
bool sample_dome(const PlacedLight& light, const Vec3f& point, Point2 random, LightSample& sample);
bool find_dome(const PlacedLight& light, const Vec3f& point, const Vec3f& direction, LightAlong& along);
Affine3f dome_rotation(const Affine3f& world_from_light);

// usdrecord's light: a white diffuse surface that faces the camera has the light's colour, at any distance.
bool sample_camera_light(const PlacedLight& light, const Camera& camera, const Vec3f& point, float time,
                         LightSample& sample);

}  // namespace msbvh
