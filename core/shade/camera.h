// Rays from the camera, anywhere on the image and at any time of the shutter.
#pragma once

#include "core/scene/scene.h"
#include "core/shade/point2.h"
#include "core/trace/ray.h"

namespace msbvh {

// `screen_x` and `screen_y` in [0, 1] run from the left and from the top edge of the image. The ray's
// parameter t is the distance along the camera's -z axis, in camera space, for both projections: the clipping
// range is its range.
Ray camera_ray(const Camera& camera, float screen_x, float screen_y, float time);

// The same through a point of the lens that `random` chooses, uniformly by area: the rays of a point of the
// image meet in the plane in focus. t still counts along -z, from the lens. The camera must have a lens.
// The camera's clipping planes shorten the range of either; where they leave nothing of it, tfar < tnear.
Ray lens_ray(const Camera& camera, float screen_x, float screen_y, float time, Point2 random);

// The rays of a frame, what does not move evaluated once. The same rays as the functions above to the bit.
class CameraRays {
 public:
  explicit CameraRays(const Camera& camera);
  Ray ray(float screen_x, float screen_y, float time) const;
  Ray still_ray(float screen_x, float screen_y, float time) const;  // of a camera without motion

 private:
  const Camera& camera_;
  Affine3f world_from_camera_;
  ScreenWindow window_;
  ClipRange clip_;
};

ClipRange clip_range(const Camera& camera, float time);

// A unit normal of the world in the camera's space, unit.
Vec3f normal_in_camera(const Camera& camera, float time, const Vec3f& normal);

// The eye's position in the world.
Vec3f camera_position(const Camera& camera, float time);

}  // namespace msbvh
