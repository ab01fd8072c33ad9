// Alpha of moving curves and points against the closed form of their coverage.
#include <cmath>

#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kWidth = 16, kRows = 128;
const RenderSettings kColumns{.width = kWidth, .height = kRows, .spp = 64, .max_bounces = 0, .build = {}};

struct Bar {
  float x, radius;
};

// A straight vertical curve through the whole picture, at each key.
Curves bar(const std::vector<Bar>& keys, CurveShape shape) {
  Curves curves;
  curves.shape.name = "/bar";
  curves.shape.shape = shape;
  curves.shape.segments = static_cast<std::uint32_t>(keys.size()) - 1;
  curves.shape.vertex_count = 4;
  for (const Bar& key : keys) {
    for (int i = 0; i < 4; ++i)
      curves.shape.vertices.push_back({{key.x, -50.0f + 80.0f * float(i), 0}, key.radius});
  }
  if (shape == CurveShape::kOriented) curves.shape.normals.assign(curves.shape.vertices.size(), {0, 0, 1});
  curves.shape.spans = {0};
  return curves;
}

Scene scene_of(Curves curves) {
  Scene scene;
  scene.camera = pixel_camera(kWidth, kRows);
  scene.curves = {std::move(curves)};
  scene.world = {curves_id(0)};
  return scene;
}

constexpr CurveShape kShapes[] = {CurveShape::kRibbon, CurveShape::kTube, CurveShape::kOriented};

TEST_CASE("a still curve covers its width") {
  for (const CurveShape shape : kShapes) {
    const Image image = render(scene_of(bar({{7.25f, 2.5f}}, shape)), kColumns);
    check_columns(image, [](std::uint32_t x) {
      const double left = std::max(double(x), 4.75), right = std::min(x + 1.0, 9.75);
      return std::max(0.0, right - left);
    });
  }
}

TEST_CASE("a translating curve") {
  for (const CurveShape shape : kShapes) {
    const Image image = render(scene_of(bar({{3, 1.25f}, {11, 1.25f}}, shape)), kColumns);
    check_columns(image, [](std::uint32_t x) { return swept(x, 4.25, 12.25) - swept(x, 1.75, 9.75); });
  }
}

TEST_CASE("a width that changes within the shutter, on two segments") {
  for (const CurveShape shape : kShapes) {
    const Image image = render(scene_of(bar({{8, 1}, {8, 3}, {8, 5}}, shape)), kColumns);
    check_columns(image, [](std::uint32_t x) { return swept(x, 9, 13) - swept(x, 7, 3); });
  }
}

TEST_CASE("a curve as a moving instance") {
  for (const CurveShape shape : kShapes) {
    Scene scene = scene_of(bar({{0, 1.25f}}, shape));
    scene.world.clear();
    scene.prototypes = {{"/prototype", {curves_id(0)}}};
    scene.instances = {{"/instance", 0, 1, {translation({3, 0, 0}), translation({11, 0, 0})}, {}}};
    check_columns(render(scene, kColumns),
                  [](std::uint32_t x) { return swept(x, 4.25, 12.25) - swept(x, 1.75, 9.75); });
  }
}

// The mean of alpha is the share of the picture's area that is covered at a time, over the shutter.
void check_area(const Scene& scene, double expected) {
  Estimates area;
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    const Image image =
        render(scene, {.width = 32, .height = 32, .spp = 16, .seed = seed, .max_bounces = 0, .build = {}});
    double sum = 0.0;
    for (std::uint32_t y = 0; y < 32; ++y) {
      for (std::uint32_t x = 0; x < 32; ++x) sum += channel(image, x, y, kAlpha);
    }
    area.add(sum);
  }
  area.check(expected, 1e-3);
}

Scene point_scene(std::vector<RoundVertex> keys) {
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  Points points;
  points.shape.name = "/points";
  points.shape.segments = static_cast<std::uint32_t>(keys.size()) - 1;
  points.shape.point_count = 1;
  points.shape.vertices = std::move(keys);
  scene.points = {points};
  scene.world = {points_id(0)};
  return scene;
}

TEST_CASE("a point covers its disc, still, moving and growing") {
  check_area(point_scene({{{15.3f, 16.2f, 0}, 9.0f}}), kPi * 81);
  check_area(point_scene({{{10, 10, 0}, 5.0f}, {{22, 21, 3}, 5.0f}}), kPi * 25);
  // The mean of r^2 from 2 to 8 is (4 + 16 + 64) / 3.
  check_area(point_scene({{{16, 16, 0}, 2.0f}, {{16, 16, 0}, 8.0f}}), kPi * 28);
}

TEST_CASE("the same points for any thread count, among meshes and curves") {
  Scene scene = point_scene({{{10, 10, 0}, 5.0f}, {{22, 21, 3}, 5.0f}});
  scene.curves = {bar({{3, 1.25f}, {11, 1.25f}}, CurveShape::kRibbon)};
  add(scene, polygon({rectangle(2, 2, 30, 9, -4)}));
  scene.world = {mesh_id(0), curves_id(0), points_id(0)};
  scene.lights = {dome({1, 1, 1})};
  RenderSettings settings{.width = 32, .height = 32, .spp = 16, .max_bounces = 2, .build = {}};
  settings.threads = 1;
  const Image one = render(scene, settings);
  settings.threads = 2;
  CHECK(render(scene, settings).rgba == one.rgba);
}

// Under a dome of radiance 1 a white convex thing returns 1 everywhere: what its rays hit of itself would be
// missing.
TEST_CASE("nothing convex shadows itself") {
  Scene scene = point_scene({{{16, 16, 0}, 12.0f}});
  Material white;
  white.diffuse_color = {1, 1, 1};
  scene.materials = {white};
  scene.lights = {dome({1, 1, 1})};
  scene.points[0].material = 0;
  const auto mean_inside = [&](const Scene& s) {
    const Image image = render(s, {.width = 32, .height = 32, .spp = 64, .max_bounces = 0, .build = {}});
    Estimates mean;
    for (std::uint32_t y = 12; y < 20; ++y) {
      for (std::uint32_t x = 14; x < 18; ++x) mean.add(channel(image, x, y, 0));
    }
    return mean;
  };
  mean_inside(scene).check(1.0, kSinglePrecision);
  for (const CurveShape shape : kShapes) {
    Curves curves = bar({{16, 4}}, shape);
    curves.material = 0;
    scene.curves = {curves};
    scene.world = {curves_id(0)};
    mean_inside(scene).check(1.0, kSinglePrecision);
  }
}

}  // namespace
}  // namespace msbvh
