#include <cmath>
#include <doctest/doctest.h>

#include "core/integrate/sampler.h"
#include "core/shade/camera.h"

namespace msbvh {
namespace {

Camera still_camera(Projection projection) {
  Camera camera;
  camera.projection = projection;
  camera.world_from_camera = {Affine3f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {10, 20, 30}}};
  camera.window = {{-2.0f, 2.0f, -1.0f, 3.0f}};
  camera.near_clip = 0.5f;
  camera.far_clip = 100.0f;
  return camera;
}

TEST_CASE("a perspective ray starts at the eye and t counts along -z") {
  const Camera camera = still_camera(Projection::kPerspective);
  const Ray corner = camera_ray(camera, 0.0f, 0.0f, 0.0f);  // top left
  CHECK(corner.org == Vec3f{10, 20, 30});
  CHECK(corner.dir == Vec3f{-2, 3, -1});
  CHECK(corner.tnear == 0.5f);
  CHECK(corner.tfar == 100.0f);
  CHECK(camera_ray(camera, 1.0f, 1.0f, 0.0f).dir == Vec3f{2, -1, -1});
  CHECK(camera_ray(camera, 0.5f, 0.5f, 0.0f).dir == Vec3f{0, 1, -1});  // the window is off centre
}

TEST_CASE("orthographic rays are parallel and start on the window") {
  const Camera camera = still_camera(Projection::kOrthographic);
  const Ray ray = camera_ray(camera, 1.0f, 0.0f, 0.0f);
  CHECK(ray.org == Vec3f{12, 23, 30});
  CHECK(ray.dir == Vec3f{0, 0, -1});
  CHECK(ray.tfar == 100.0f);
}

TEST_CASE("the camera and its window move by key") {
  Camera camera = still_camera(Projection::kPerspective);
  camera.segments = 2;
  const Affine3f start = camera.world_from_camera[0];
  Affine3f middle = start, end = start;
  middle.t = {10, 24, 30};
  end.t = {10, 24, 38};
  camera.world_from_camera = {start, middle, end};
  camera.window = {{-1, 1, -1, 1}, {-1, 1, -1, 1}, {-3, 3, -1, 1}};
  CHECK(camera_ray(camera, 0.5f, 0.5f, 0.25f).org == Vec3f{10, 22, 30});
  CHECK(camera_ray(camera, 0.5f, 0.5f, 0.75f).org == Vec3f{10, 24, 34});
  CHECK(camera_ray(camera, 1.0f, 0.5f, 0.75f).dir == Vec3f{2, 0, -1});
  CHECK(camera_position(camera, 1.0f) == Vec3f{10, 24, 38});
  CHECK(camera_ray(camera, 0.5f, 0.5f, 0.75f).time == 0.75f);
}

TEST_CASE("the clipping range moves by key") {
  Camera camera = still_camera(Projection::kPerspective);
  camera.segments = 2;
  camera.world_from_camera.resize(3, camera.world_from_camera[0]);
  camera.window.resize(3, camera.window[0]);
  camera.clip = {{1, 10}, {3, 20}, {2, 100}};
  const Ray ray = camera_ray(camera, 0.5f, 0.5f, 0.25f);
  CHECK(ray.tnear == 2.0f);
  CHECK(ray.tfar == 15.0f);
  CHECK(camera_ray(camera, 0.5f, 0.5f, 1.0f).tfar == 100.0f);
}

TEST_CASE("rays through a lens meet in the plane in focus and start on the disc") {
  Camera camera = still_camera(Projection::kPerspective);
  camera.lens = {{0.5f, 4.0f}};
  const Ray pinhole = camera_ray(camera, 0.25f, 0.75f, 0.0f);
  const Vec3f in_focus = pinhole.org + pinhole.dir * 4.0f;
  double sum = 0;
  for (int i = 0; i < 256; ++i) {
    const Ray ray =
        lens_ray(camera, 0.25f, 0.75f, 0.0f, Sampler(PixelSampler(0, i, 0), 0).pair(Dimension::kLens, 0));
    CHECK(length(ray.org + ray.dir * 4.0f - in_focus) <= 1e-5f);
    const Vec3f on_lens = ray.org - pinhole.org;
    CHECK(length(on_lens) <= 0.5f + 1e-5f);
    CHECK(on_lens.z == 0.0f);
    CHECK(ray.dir.z == -1.0f);
    CHECK(ray.tnear == 0.5f);
    sum += dot(on_lens, on_lens);
  }
  // Uniform by area: half the radius squared, within 4.5 standard deviations of 256 independent samples.
  CHECK(std::abs(sum / 256 - 0.125) <= 4.5 * 0.25 / std::sqrt(12.0 * 256));
}

TEST_CASE("lens radius and focus move by key") {
  Camera camera = still_camera(Projection::kPerspective);
  camera.segments = 1;
  camera.world_from_camera.resize(2, camera.world_from_camera[0]);
  camera.window.resize(2, camera.window[0]);
  camera.lens = {{0.0f, 2.0f}, {1.0f, 6.0f}};
  const Ray pinhole = camera_ray(camera, 0.0f, 0.0f, 0.5f);
  const Ray ray = lens_ray(camera, 0.0f, 0.0f, 0.5f, {1.0f, 0.5f});  // the rim, along +x
  CHECK(length(ray.org - pinhole.org - Vec3f{0.5f, 0, 0}) <= 1e-6f);
  CHECK(length(ray.dir - pinhole.dir - Vec3f{-0.125f, 0, 0}) <= 1e-6f);
}

TEST_CASE("clipping planes shorten rays, and leave nothing of those that they cut off") {
  Camera camera = still_camera(Projection::kPerspective);
  camera.window = {{-1.0f, 1.0f, -1.0f, 1.0f}};
  camera.clipping_planes = {{{0, 0, -1}, -2.0f}, {{0, 0, 1}, 50.0f}};  // from 2 to 50 in front
  const Ray between = camera_ray(camera, 0.5f, 0.5f, 0.0f);
  CHECK(between.tnear == 2.0f);
  CHECK(between.tfar == 50.0f);
  camera.clipping_planes = {{{1, 0, 0}, 0.0f}};  // the right half
  CHECK(camera_ray(camera, 1.0f, 0.5f, 0.0f).tfar == 100.0f);
  const Ray left = camera_ray(camera, 0.0f, 0.5f, 0.0f);
  CHECK(left.tfar < left.tnear);
  CHECK(CameraRays(camera).ray(0.0f, 0.5f, 0.0f).tfar == left.tfar);
  camera.clipping_planes = {{{0, 1, 0}, -1.0f}};  // parallel to the ray in the middle, and above it
  const Ray below = camera_ray(camera, 0.5f, 0.5f, 0.0f);
  CHECK(below.tfar < below.tnear);
  camera = still_camera(Projection::kOrthographic);
  camera.clipping_planes = {{{0, 0, -1}, -2.0f}};
  CHECK(camera_ray(camera, 0.5f, 0.5f, 0.0f).tnear == 2.0f);
}

TEST_CASE("clipping planes cut the rays of a lens where they are") {
  Camera camera = still_camera(Projection::kPerspective);
  camera.lens = {{0.5f, 10.0f}};
  camera.clipping_planes = {{{0.6f, 0, -0.8f}, -2.0f}};
  for (const float random : {0.1f, 0.6f, 0.9f}) {
    const Ray ray = lens_ray(camera, 0.3f, 0.7f, 0.0f, {random, random});
    const Vec3f at = ray.org + ray.dir * ray.tnear - camera.world_from_camera[0].t;
    CHECK(double(0.6f * at.x - 0.8f * at.z - 2.0f) == doctest::Approx(0.0).epsilon(1e-4));
  }
}

}  // namespace
}  // namespace msbvh
