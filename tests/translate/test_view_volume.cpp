// What the view volume says that camera rays miss, against camera rays.
#include <doctest/doctest.h>
#include <random>

#include "core/shade/camera.h"
#include "delegate/translate/view_volume.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  float in(float a, float b) { return std::uniform_real_distribution<float>(a, b)(engine_); }
  Vec3f vector(float size) { return {in(-size, size), in(-size, size), in(-size, size)}; }

 private:
  std::mt19937 engine_;
};

// Turned, sheared a little and scaled, at a few units from the origin; the last one mirrors.
Affine3f near(const Affine3f& map, Random& random, float change) {
  return {map.x + random.vector(change), map.y + random.vector(change), map.z + random.vector(change),
          map.t + random.vector(4 * change)};
}

Camera moving_camera(Random& random, Projection projection, bool with_lens, bool mirrors) {
  Camera camera;
  camera.projection = projection;
  camera.segments = 2;
  camera.degree = 2;
  Affine3f map{{mirrors ? -1.0f : 1.0f, 0, 0}, {0, 1, 0}, {0, 0, 1}, random.vector(3)};
  map = near(map, random, 0.3f);
  for (std::uint32_t c = 0; c < camera.form().controls(); ++c) {
    camera.world_from_camera.push_back(near(map, random, 0.08f));
    const float zoom = random.in(0.4f, 0.8f);
    camera.window.push_back({-zoom, zoom * 1.1f, -0.7f * zoom, 0.6f * zoom});
    if (with_lens) camera.lens.push_back({random.in(0.0f, 0.5f), random.in(1.0f, 6.0f)});
  }
  camera.near_clip = 0.01f;
  return camera;
}

bool meets(const Ray& ray, const Box3d& box) {
  double from = ray.tnear, to = ray.tfar;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.lo[axis] - double(ray.org[axis])) / double(ray.dir[axis]);
    const double b = (box.hi[axis] - double(ray.org[axis])) / double(ray.dir[axis]);
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

// Of boxes around the camera, how many are missed; fails where a ray meets one of these.
int missed(const Camera& camera, Random& random, int boxes, int rays) {
  const ViewVolume view(camera, 64, 64);
  int result = 0, met = 0;
  for (int i = 0; i < boxes; ++i) {
    const Vec3d center(random.vector(8)), half(Vec3f{0.2f, 0.2f, 0.2f} + abs(random.vector(0.8f)));
    const Box3d box{center - half, center + half};
    if (!view.misses(box)) continue;
    ++result;
    for (int r = 0; r < rays; ++r) {
      const float x = random.in(0, 1), y = random.in(0, 1), time = random.in(0, 1);
      const Ray ray = camera.lens.empty() ? camera_ray(camera, x, y, time)
                                          : lens_ray(camera, x, y, time, {random.in(0, 1), random.in(0, 1)});
      met += meets(ray, box);
    }
  }
  CHECK(met == 0);
  return result;
}

}  // namespace

TEST_SUITE("view volume") {
  TEST_CASE("no ray of a moving camera, with or without a lens, meets what the volume misses") {
    Random random(7);
    for (int round = 0; round < 8; ++round) {
      CHECK(missed(moving_camera(random, Projection::kPerspective, false, round == 7), random, 200, 100) >
            40);
      CHECK(missed(moving_camera(random, Projection::kPerspective, true, round == 7), random, 200, 100) > 20);
      CHECK(missed(moving_camera(random, Projection::kOrthographic, false, round == 7), random, 200, 100) >
            40);
    }
  }

  TEST_CASE("what the picture shows at any time is not missed") {
    Camera camera;
    camera.world_from_camera = {Affine3f{}};
    camera.window = {ScreenWindow{}};
    const Box3d ahead{{-1, -1, -11}, {1, 1, -10}}, beside{{19, -1, -11}, {21, 1, -10}};
    CHECK_FALSE(ViewVolume(camera, 64, 64).misses(ahead));
    CHECK(ViewVolume(camera, 64, 64).misses(beside));
    CHECK(ViewVolume(camera, 64, 64).misses({{-1, -1, 1}, {1, 1, 2}}));  // behind
    // It slides past what stands beside, and is elsewhere at both ends.
    camera.segments = 2;
    camera.world_from_camera = {Affine3f{}, Affine3f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {20, 0, 0}},
                                Affine3f{}};
    camera.window.assign(3, ScreenWindow{});
    CHECK_FALSE(ViewVolume(camera, 64, 64).misses(beside));
    // A wide lens, far out of focus, sees what a pinhole does not.
    camera.segments = 0;
    camera.world_from_camera.resize(1);
    camera.window.resize(1);
    camera.lens = {{10.0f, 1.0f}};
    CHECK_FALSE(ViewVolume(camera, 64, 64).misses(beside));
    // One that pulls its focus close sees far aside at the end alone.
    const Box3d aside{{60, -1, -11}, {62, 1, -10}};
    camera.segments = 1;
    camera.world_from_camera.assign(2, Affine3f{});
    camera.window.assign(2, ScreenWindow{});
    camera.lens = {{10.0f, 100.0f}, {10.0f, 100.0f}};
    CHECK(ViewVolume(camera, 64, 64).misses(aside));
    camera.lens[1].focus_distance = 1.0f;
    CHECK_FALSE(ViewVolume(camera, 64, 64).misses(aside));
  }
}
