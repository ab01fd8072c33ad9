#include "core/shade/camera.h"

#include "core/motion/affine_track.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

ScreenWindow window_at(const Camera& camera, float time) {
  if (camera.segments == 0) return camera.window[0];
  const SegmentTime at = locate(time, camera.segments);
  const ScreenWindow &a = camera.window[at.key], &b = camera.window[at.key + 1];
  return {lerp(a.left, b.left, at.w), lerp(a.right, b.right, at.w), lerp(a.bottom, b.bottom, at.w),
          lerp(a.top, b.top, at.w)};
}

Lens lens_at(const Camera& camera, float time) {
  if (camera.segments == 0) return camera.lens[0];
  const SegmentTime at = locate(time, camera.segments);
  const Lens &a = camera.lens[at.key], &b = camera.lens[at.key + 1];
  return {lerp(a.radius, b.radius, at.w), lerp(a.focus_distance, b.focus_distance, at.w)};
}

}  // namespace

Ray camera_ray(const Camera& camera, float screen_x, float screen_y, float time) {
  const ScreenWindow window = window_at(camera, time);
  const float x = lerp(window.left, window.right, screen_x);
  const float y = lerp(window.top, window.bottom, screen_y);
  const bool perspective = camera.projection == Projection::kPerspective;
  const Vec3f origin = perspective ? Vec3f{} : Vec3f{x, y, 0.0f};
  const Vec3f direction = perspective ? Vec3f{x, y, -1.0f} : Vec3f{0.0f, 0.0f, -1.0f};

  const Affine3f world_from_camera = evaluate(camera.world_from_camera, camera.segments, time);
  Ray ray;
  ray.org = world_from_camera.point(origin);
  ray.dir = world_from_camera.vector(direction);
  ray.tnear = camera.near_clip;
  ray.tfar = camera.far_clip;
  ray.time = time;
  return ray;
}

Ray lens_ray(const Camera& camera, float screen_x, float screen_y, float time, Point2 random) {
  Ray ray = camera_ray(camera, screen_x, screen_y, time);
  const Lens lens = lens_at(camera, time);
  const Point2 on_disc = sample_disc(random);
  const Vec3f on_lens{lens.radius * on_disc.x, lens.radius * on_disc.y, 0.0f};
  const Affine3f world_from_camera = evaluate(camera.world_from_camera, camera.segments, time);
  const Vec3f offset = world_from_camera.vector(on_lens);
  ray.org += offset;
  ray.dir = ray.dir - offset * (1.0f / lens.focus_distance);
  return ray;
}

Vec3f camera_position(const Camera& camera, float time) {
  return evaluate(camera.world_from_camera, camera.segments, time).t;
}

}  // namespace msbvh
