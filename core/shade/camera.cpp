#include "core/shade/camera.h"

#include <algorithm>
#include <limits>

#include "core/motion/bezier.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// The camera's tracks at a time of the shutter.
class CameraTime {
 public:
  CameraTime(const Camera& camera, float time) : camera_(camera), time_(time) {
    camera.time_remap.at(time, time_);
  }

  Affine3f world_from_camera() const { return value(camera_.world_from_camera); }
  ScreenWindow window() const { return value(camera_.window); }
  Lens lens() const { return value(camera_.lens); }
  ClipRange clip() const {
    return camera_.clip.empty() ? ClipRange{camera_.near_clip, camera_.far_clip} : value(camera_.clip);
  }

 private:
  template <typename T>
  T value(const std::vector<T>& controls) const {
    const SegmentTime at = locate(time_, camera_.segments);
    return track_value(controls.data(), camera_.form(), at.key, at.w);
  }
  const Camera& camera_;
  float time_;
};

// A ray in the camera's space.
struct Sight {
  Vec3f origin, direction;
};

// Leaves of a ray's range what no plane cuts off: planes are half-spaces, so that is one range again.
void cut_off(const std::vector<ClippingPlane>& planes, const Sight& sight, Ray& ray) {
  for (const ClippingPlane& plane : planes) {
    const float at_origin = dot(plane.normal, sight.origin) + plane.offset;
    const float slope = dot(plane.normal, sight.direction);
    if (slope > 0.0f) {
      ray.tnear = std::max(ray.tnear, -at_origin / slope);
    } else if (slope < 0.0f) {
      ray.tfar = std::min(ray.tfar, -at_origin / slope);
    } else if (at_origin < 0.0f) {
      ray.tfar = -std::numeric_limits<float>::infinity();
    }
  }
}

Sight sight_through(const Camera& camera, const ScreenWindow& window, float screen_x, float screen_y) {
  const float x = lerp(window.left, window.right, screen_x);
  const float y = lerp(window.top, window.bottom, screen_y);
  if (camera.projection == Projection::kPerspective) return {{}, {x, y, -1.0f}};
  return {{x, y, 0.0f}, {0.0f, 0.0f, -1.0f}};
}

Ray ray_through(const Camera& camera, const Affine3f& world_from_camera, const ScreenWindow& window,
                const ClipRange& clip, float screen_x, float screen_y, float time) {
  const Sight sight = sight_through(camera, window, screen_x, screen_y);
  Ray ray;
  ray.org = world_from_camera.point(sight.origin);
  ray.dir = world_from_camera.vector(sight.direction);
  ray.tnear = clip.near_clip;
  ray.tfar = clip.far_clip;
  ray.time = time;
  if (!camera.clipping_planes.empty()) cut_off(camera.clipping_planes, sight, ray);
  return ray;
}

}  // namespace

Ray camera_ray(const Camera& camera, float screen_x, float screen_y, float time) {
  const CameraTime at(camera, time);
  return ray_through(camera, at.world_from_camera(), at.window(), at.clip(), screen_x, screen_y, time);
}

CameraRays::CameraRays(const Camera& camera) : camera_(camera) {
  const CameraTime at(camera, 0.0f);
  world_from_camera_ = at.world_from_camera();
  window_ = at.window();
  clip_ = at.clip();
}

Ray CameraRays::ray(float screen_x, float screen_y, float time) const {
  if (camera_.segments != 0) return camera_ray(camera_, screen_x, screen_y, time);
  return still_ray(screen_x, screen_y, time);
}

Ray CameraRays::still_ray(float screen_x, float screen_y, float time) const {
  return ray_through(camera_, world_from_camera_, window_, clip_, screen_x, screen_y, time);
}

Ray lens_ray(const Camera& camera, float screen_x, float screen_y, float time, Point2 random) {
  Ray ray = camera_ray(camera, screen_x, screen_y, time);
  const CameraTime at(camera, time);
  const Lens lens = at.lens();
  const Point2 on_disc = sample_disc(random);
  const Vec3f on_lens{lens.radius * on_disc.x, lens.radius * on_disc.y, 0.0f};
  const Vec3f offset = at.world_from_camera().vector(on_lens);
  ray.org += offset;
  ray.dir = ray.dir - offset * (1.0f / lens.focus_distance);
  if (camera.clipping_planes.empty()) return ray;
  const Vec3f through = sight_through(camera, at.window(), screen_x, screen_y).direction;
  const ClipRange clip = at.clip();
  ray.tnear = clip.near_clip;
  ray.tfar = clip.far_clip;
  cut_off(camera.clipping_planes, {on_lens, through - on_lens * (1.0f / lens.focus_distance)}, ray);
  return ray;
}

ClipRange clip_range(const Camera& camera, float time) { return CameraTime(camera, time).clip(); }

// By the transpose, since normals move by the inverse transpose and the camera's space is where to.
Vec3f normal_in_camera(const Camera& camera, float time, const Vec3f& normal) {
  const Affine3f m = CameraTime(camera, time).world_from_camera();
  return normalize(Vec3f{dot(m.x, normal), dot(m.y, normal), dot(m.z, normal)});
}

Vec3f camera_position(const Camera& camera, float time) {
  return CameraTime(camera, time).world_from_camera().t;
}

}  // namespace msbvh
