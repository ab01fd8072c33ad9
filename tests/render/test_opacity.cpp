// Alpha is coverage times opacity; shadows let the rest through.
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

const RenderSettings kSettings{.width = 8, .height = 64, .spp = 16, .max_bounces = 0, .build = {}};

Mesh layer(float z, float opacity) {
  Mesh mesh = polygon({rectangle(-100, -100, 200, 200, z)});
  mesh.display_opacity.values = {opacity};
  return mesh;
}

Scene layers(const std::vector<float>& opacities) {
  Scene scene;
  scene.camera = pixel_camera(8, 64);
  for (const float opacity : opacities) {
    add(scene, layer(-static_cast<float>(scene.meshes.size()), opacity));
  }
  return scene;
}

TEST_CASE("alpha is the opacity of one layer, and of several") {
  check_columns(render(layers({0.3f}), kSettings), [](std::uint32_t) { return 0.3; });
  check_columns(render(layers({0.3f, 0.4f, 0.5f}), kSettings),
                [](std::uint32_t) { return 1 - 0.7 * 0.6 * 0.5; });
  check_columns(render(layers({0.3f, 1.0f}), kSettings), [](std::uint32_t) { return 1.0; });
  check_columns(render(layers({0.0f}), kSettings), [](std::uint32_t) { return 0.0; });
}

TEST_CASE("alpha is coverage times opacity while the edge moves") {
  Scene scene;
  scene.camera = pixel_camera(8, 64);
  add(scene, polygon({rectangle(-9, -9, 1, 99), rectangle(-9, -9, 6, 99)}));
  scene.meshes[0].display_opacity.values = {0.5f};
  check_columns(render(scene, kSettings), [](std::uint32_t x) { return 0.5 * swept(x, 1, 6); });
}

TEST_CASE("radiance is premultiplied, and a dome shines through if it is shown") {
  Scene scene = layers({0.3f});
  scene.meshes[0].display_color.values = {{0.5f, 0.5f, 0.5f}};
  scene.lights = {dome({2, 0, 0})};
  RenderSettings settings = kSettings;
  for (const bool show_domes : {true, false}) {
    settings.show_domes = show_domes;
    const Image image = render(scene, settings);
    for (std::uint32_t i = 0; i < 8 * 64; ++i) {
      const float alpha = image.rgba[4 * i + kAlpha], behind = show_domes ? 2.0f : 0.0f;
      CHECK(image.rgba[4 * i] == doctest::Approx(1.0 * alpha + behind * (1 - alpha)).epsilon(1e-5));
    }
  }
}

TEST_CASE("shadow rays are dimmed by each layer they pass, exactly") {
  Scene scene = layers({1.0f});
  scene.meshes[0].display_color.values = {{1, 1, 1}};
  for (const float opacity : {0.25f, 0.5f}) {
    Mesh blocker = polygon({rectangle(20, -100, 120, 200, 50.0f + opacity)});
    blocker.display_opacity.values = {opacity};
    add(scene, blocker);
  }
  Light sun;
  sun.angle_degrees = 0.0f;
  sun.world_from_light = {Affine3f{{1, 0, -1}, {0, 1, 0}, {1, 0, 1}, {}}};  // from (1, 0, 1)
  sun.radiance = {1, 1, 1};
  scene.lights = {sun};
  const Image image = render(scene, kSettings);
  CHECK(channel(image, 4, 30, 0) == doctest::Approx(0.75 * 0.5 * std::sqrt(0.5) / kPi).epsilon(1e-5));
}

TEST_CASE("a threshold makes a cut-out") {
  Scene scene = layers({0.4f});
  scene.meshes[0].material = 0;
  scene.materials.resize(1);
  scene.materials[0].opacity_from_display_opacity = true;
  scene.materials[0].opacity_threshold = 0.5f;
  check_columns(render(scene, kSettings), [](std::uint32_t) { return 0.0; });
  scene.materials[0].opacity_threshold = 0.3f;
  check_columns(render(scene, kSettings), [](std::uint32_t) { return 1.0; });
}

TEST_CASE("an opacity that fades within the shutter gives its mean, and a moving card a streak that fades") {
  Scene scene;
  scene.camera = pixel_camera(16, 16);
  Mesh card = polygon({rectangle(0, 0, 16, 16)});
  card.display_opacity.segments = 2;
  card.display_opacity.values = {1.0f, 0.5f, 0.0f};
  SUBCASE("still: the mean of 1, 0.5, 0 by halves") {
    add(scene, card);
    const Image image = render(scene, {.width = 16, .height = 16, .spp = 64, .max_bounces = 0, .build = {}});
    Estimates pixels;
    for (std::uint32_t i = 0; i < 256; ++i) pixels.add(image.rgba[4 * i + kAlpha]);
    pixels.check(0.5, kSinglePrecision);
  }
  SUBCASE("a thin card sweeps the picture: at x it is as opaque as at the time it is there") {
    Mesh sweep = polygon({rectangle(-1, 0, 0, 16), rectangle(16, 0, 17, 16)});
    sweep.display_opacity = card.display_opacity;
    add(scene, sweep);
    const Image image =
        render(scene, {.width = 16, .height = 16, .spp = 4096, .max_bounces = 0, .build = {}});
    for (std::uint32_t x = 1; x < 15; ++x) {
      Estimates column;
      for (std::uint32_t y = 0; y < 16; ++y) column.add(channel(image, x, y, kAlpha));
      // Over [17 u - 1, 17 u]: for 1 / 17 of the shutter, about the time (x + 1) / 17.
      column.check((1.0 - (x + 1.0) / 17) / 17, kSinglePrecision);
    }
  }
}

TEST_CASE("a colour that changes within the shutter gives its mean") {
  Scene scene;
  scene.camera = pixel_camera(8, 8);
  scene.lights = {camera_light()};
  Mesh card = polygon({rectangle(-50, -50, 60, 60)});
  card.display_color.segments = 1;
  card.display_color.values = {{1, 0, 0.25f}, {0, 1, 0.25f}};
  add(scene, card);
  scene.camera.world_from_camera = {translation({0, 0, 1e6f})};
  scene.camera.far_clip = 1e7f;
  const Image image = render(scene, {.width = 8, .height = 8, .spp = 64, .max_bounces = 0, .build = {}});
  Estimates red, green;
  for (std::uint32_t i = 0; i < 64; ++i) {
    red.add(image.rgba[4 * i]);
    green.add(image.rgba[4 * i + 1]);
    CHECK(image.rgba[4 * i + 2] == doctest::Approx(0.25).epsilon(1e-5));
  }
  red.check(0.5, 1e-5);
  green.check(0.5, 1e-5);
}

}  // namespace
}  // namespace msbvh
