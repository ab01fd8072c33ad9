// AOVs of light by its way, of noise and of cost.
#include <algorithm>
#include <cmath>

#include "core/api/scene_trees.h"
#include "core/integrate/sampler.h"
#include "core/shade/camera.h"
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

const AovImage& layer(const Image& image, Aov aov) {
  return *std::ranges::find(image.aovs, aov, &AovImage::aov);
}
double value(const Image& image, Aov aov, std::size_t pixel, std::size_t number = 0) {
  return layer(image, aov).values[pixel * form_of(aov).numbers + number];
}

const std::vector<Aov> kLight{Aov::kDirectDiffuse, Aov::kDirectSpecular, Aov::kIndirectDiffuse,
                              Aov::kIndirectSpecular, Aov::kEmission};

double sum_of(const Image& image, std::size_t pixel, std::size_t c) {
  double sum = 0.0;
  for (const Aov aov : kLight) sum += value(image, aov, pixel, c);
  return sum;
}

// A floor, a glowing wall beside it, and what else a case adds.
Scene glowing_corner() {
  Scene scene;
  scene.camera = pixel_camera(8, 8);
  Mesh floor = polygon({rectangle(-20, -20, 20, 20)}),
       wall = polygon({{{6, -20, 0}, {6, 20, 0}, {6, 20, 20}, {6, -20, 20}}}),
       lamp = polygon({rectangle(0, 0, 1, 1, 30.0f)});
  floor.display_color.values = {{0.8f, 0.5f, 0.2f}};
  scene.materials = {{.name = "/glow", .diffuse_color = {0.5f, 0.5f, 0.5f}, .emissive_color = {1, 2, 3}}};
  wall.material = lamp.material = 0;
  add(scene, floor);
  add(scene, wall);
  add(scene, lamp);
  return scene;
}

TEST_CASE("light by its ways sums up to colour, whatever gives it") {
  for (int bits = 0; bits < 16; ++bits) {
    CAPTURE(bits);
    Scene scene = glowing_corner();
    if (bits & 1) scene.lights.push_back(dome({0.2f, 0.3f, 0.4f}));
    if (bits & 2) scene.lights.push_back(camera_light());
    if (bits & 4) {
      Light sun;
      sun.name = "/sun";
      sun.world_from_light = {Affine3f{}};
      sun.angle_degrees = 20.0f;
      scene.lights.push_back(sun);
    }
    if (bits & 8) scene.meshes[0].display_opacity.values = {0.5f};
    const Image image =
        render(scene, {.width = 8, .height = 8, .spp = 16, .max_bounces = 2, .aovs = kLight, .build = {}});
    double indirect = 0.0;
    for (std::size_t pixel = 0; pixel < 64; ++pixel) {
      for (std::size_t c = 0; c < 3; ++c) {
        CHECK(sum_of(image, pixel, c) == doctest::Approx(image.rgba[4 * pixel + c]).epsilon(1e-5));
        CHECK(value(image, Aov::kDirectSpecular, pixel, c) == 0.0);  // all is diffuse
        indirect += value(image, Aov::kIndirectDiffuse, pixel, c);
      }
    }
    if (bits & 7) CHECK(indirect > 0.0);
  }
}

TEST_CASE("what each way holds, by where light comes from") {
  Scene scene;
  scene.camera = pixel_camera(2, 1);
  Mesh floor = polygon({rectangle(0, 0, 1, 1)});
  floor.display_color.values = {{0.5f, 0.5f, 0.5f}};
  scene.materials = {{.name = "/glow", .diffuse_color = {}, .emissive_color = {1, 2, 3}}};
  Mesh lamp = polygon({rectangle(1, 0, 2, 1)});
  lamp.material = 0;
  add(scene, floor);
  add(scene, lamp);
  scene.lights = {dome({0.25f, 0.25f, 0.25f})};
  // A flat floor under an even dome reflects its albedo; nothing faces it that could light it indirectly.
  for (const std::uint32_t bounces : {0u, 3u}) {
    const Image image = render(
        scene, {.width = 2, .height = 1, .spp = 64, .max_bounces = bounces, .aovs = kLight, .build = {}});
    CHECK(value(image, Aov::kDirectDiffuse, 0) == doctest::Approx(0.125).epsilon(1e-5));
    CHECK(value(image, Aov::kIndirectDiffuse, 0) == doctest::Approx(0.0));
    CHECK(value(image, Aov::kEmission, 0) == 0.0);
    CHECK(value(image, Aov::kEmission, 1, 2) == 3.0);
    CHECK(value(image, Aov::kDirectDiffuse, 1) == 0.0);
  }
  // A dome that is seen behind the scene comes straight to the camera.
  scene.meshes[1].display_opacity.values = {0.0f};
  scene.materials[0].opacity = 0.0f;
  const Image seen =
      render(scene, {.width = 2, .height = 1, .spp = 4, .max_bounces = 1, .aovs = kLight, .build = {}});
  CHECK(value(seen, Aov::kEmission, 1) == doctest::Approx(0.25));
}

TEST_CASE("samples are counted, and the error of their mean is that of pictures by other seeds") {
  Scene scene;
  scene.camera = pixel_camera(16, 16);
  add(scene, polygon({rectangle(0, 0, 16, 9.5f)}));
  scene.lights = {dome({1, 1, 1})};
  RenderSettings settings{.width = 16,
                          .height = 16,
                          .spp = 64,
                          .sampling = Sampling::kIndependent,
                          .max_bounces = 0,
                          .aovs = {Aov::kSampleCount, Aov::kNoise},
                          .build = {}};
  settings.show_domes = false;
  double expected = 0.0, found = 0.0;
  constexpr int kSeeds = 40;
  std::vector<double> sum(16), squares(16);
  for (int seed = 0; seed < kSeeds; ++seed) {
    settings.seed = std::uint32_t(seed);
    const Image image = render(scene, settings);
    CHECK(value(image, Aov::kSampleCount, 0) == 64.0);
    for (std::size_t x = 0; x < 16; ++x) {
      const std::size_t pixel = 16 * 6 + x;  // half of it is the wall, whose edge is at y = 9.5
      expected += std::pow(value(image, Aov::kNoise, pixel), 2.0) / (16 * kSeeds);
      const double green = image.rgba[4 * pixel + 1];
      sum[x] += green;
      squares[x] += green * green;
    }
    CHECK(value(image, Aov::kNoise, 0) == 0.0);  // no wall
  }
  for (std::size_t x = 0; x < 16; ++x) found += (squares[x] - sum[x] * sum[x] / kSeeds) / (kSeeds - 1) / 16;
  CHECK(found / expected == doctest::Approx(1.0).epsilon(0.25));
  // A wall of 0.18 that covers half: the variance of one sample is 0.18^2 / 4.
  CHECK(expected == doctest::Approx(0.18 * 0.18 / 4 / 64).epsilon(0.05));
}

TEST_CASE("heat maps count what camera rays meet") {
  Scene scene;
  scene.camera = pixel_camera(2, 1);
  add(scene, polygon({rectangle(0, 0, 1, 1)}));
  add(scene, polygon({rectangle(0.5f, 0, 2, 1, 50.0f)}));
  const Image image = render(scene, {.width = 2,
                                     .height = 1,
                                     .spp = 8,
                                     .max_bounces = 2,
                                     .aovs = {Aov::kNodeVisits, Aov::kPrimitiveTests},
                                     .build = {}});
  const SceneTrees trees(std::make_shared<const Scene>(scene), {}, nullptr);
  const Tracer tracer(trees.world().bvh());
  for (std::uint32_t x = 0; x < 2; ++x) {
    const PixelSampler pixel(0, x, 0);
    TraceCounts counts;
    for (std::uint32_t s = 0; s < 8; ++s) {
      const Point2 in_pixel = pixel.position(s);
      Hit hit;
      tracer.intersect_counted(
          camera_ray(scene.camera, (float(x) + in_pixel.x) / 2.0f, in_pixel.y, pixel.time(s)), hit, counts);
    }
    CHECK(value(image, Aov::kNodeVisits, x) == double(counts.nodes) / 8);
    CHECK(value(image, Aov::kPrimitiveTests, x) == double(counts.primitives) / 8);
    CHECK(counts.primitives > 0);
  }
}

}  // namespace
}  // namespace msbvh
