// How a point of a surface moves through the world, and over the picture.
#pragma once

#include "core/base/vec.h"
#include "core/motion/track_rate.h"
#include "core/scene/camera.h"
#include "core/shade/scene_index.h"
#include "core/trace/ray.h"

namespace msbvh {

// The point of the surface that was hit at another time of the shutter: of a triangle, by its barycentric
// coordinates; of a curve or a point, what keeps its distance to the centre. In the world, and per unit of
// the shutter.
// `offset`: of what was hit from the centre, in the world; not read of triangles.
Moving<Vec3d> point_in_world(const HitSource& source, const Hit& hit, const Vec3d& offset, float time,
                             Side side);
// For `offset`: the centre of what was hit at the ray's time; of triangles the point itself.
inline Vec3d centre_of(const HitSource& source, const Hit& hit, float time) {
  return point_in_world(source, hit, {}, time, Side::kAfter).value;
}

// Pixels from the picture's lower left corner, x to the right and y up.
struct ScreenPoint {
  double x = 0.0, y = 0.0;
};
constexpr ScreenPoint operator-(const ScreenPoint& a, const ScreenPoint& b) { return {a.x - b.x, a.y - b.y}; }
constexpr ScreenPoint operator*(const ScreenPoint& a, double s) { return {a.x * s, a.y * s}; }

// Where the camera, which may move itself, sees a moving point at that time. False for a point that a
// perspective camera has not before it.
bool point_on_screen(const Camera& camera, const Moving<Vec3d>& world, float time, Side side,
                     std::uint32_t width, std::uint32_t height, Moving<ScreenPoint>& screen);

// In camera space.
Vec3d point_in_camera(const Camera& camera, const Vec3d& world, float time);

}  // namespace msbvh
