// What is transparent and yet reflects, what bends light, bumps that nothing drives, and hair.
#include <array>

#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 32;

RenderSettings settings(std::uint32_t spp, std::uint32_t bounces, bool refraction = false) {
  return {.width = kSize,
          .height = kSize,
          .spp = spp,
          .max_bounces = bounces,
          .refraction = refraction,
          .build = {}};
}

Material glass(float opacity = 0.0f) {
  return {.name = "/glass",
          .diffuse_color = {1, 1, 1},
          .opacity = opacity,
          .specular = true,
          .roughness = 0.0f,
          .transparent_reflects = true};
}

Light sun(const Vec3f& towards_it) {
  Light light;
  light.name = "/sun";
  light.angle_degrees = 0.0f;
  const Vec3f z = normalize(towards_it);
  light.world_from_light = {Affine3f{{1, 0, 0}, {0, 1, 0}, z, {}}};
  light.radiance = {1, 1, 1};
  return light;
}

// All of the picture behind a card of a material.
Scene card(const Material& material) {
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  add(scene, polygon({rectangle(-100, -100, 200, 200)}));
  scene.materials = {material};
  scene.meshes[0].material = 0;
  return scene;
}

// A ball in the middle of the picture.
Scene ball(const Material& material) {
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  Points points;
  points.shape.name = "/ball";
  points.shape.point_count = 1;
  points.shape.vertices = {{{16, 16, 0}, 14.0f}};
  points.material = 0;
  scene.points = {points};
  scene.world = {points_id(0)};
  scene.materials = {material};
  return scene;
}

double mean_of(const Image& image, int c) {
  double sum = 0.0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += double(image.rgba[i + std::size_t(c)]);
  return sum / (double(image.rgba.size()) / 4.0);
}

TEST_CASE("at opacity 0 a presence is nowhere, and what is transparent reflects") {
  Scene scene = ball(glass());
  scene.lights = {dome({1, 1, 1})};
  RenderSettings shown = settings(64, 2);
  shown.show_domes = false;
  const Image transparent = render(scene, shown);
  // Head-on 4 %, grazing all: by Schlick's term 0.04 + 0.96 / 21 over the disk, in front; what lies behind
  // the front reflects into it as well.
  CHECK(channel(transparent, 16, 16, kAlpha) < 0.25f);
  CHECK(channel(transparent, 16, 16, kAlpha) > 0.0f);
  CHECK(mean_of(transparent, kAlpha) > 0.05);
  CHECK(mean_of(transparent, 0) > 0.05);
  scene.materials[0].transparent_reflects = false;
  const Image presence = render(scene, shown);
  CHECK(std::ranges::all_of(presence.rgba, [](float x) { return x == 0.0f; }));
}

TEST_CASE("a card's alpha is what it reflects and its opacity; light that passes is the rest") {
  for (const float opacity : {0.0f, 0.3f, 1.0f}) {
    CAPTURE(opacity);
    const Scene scene = card(glass(opacity));
    Estimates alpha;
    const Image image = render(scene, settings(64, 0));
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) alpha.add(double(image.rgba[i]));
    alpha.check(1.0 - (1.0 - double(opacity)) * 0.96, 2e-3);  // 4 % head-on
  }
}

TEST_CASE("in a white furnace a white card that is transparent shows nothing but white") {
  for (const float opacity : {0.0f, 0.5f, 0.9f}) {
    for (const float roughness : {0.0f, 0.5f, 1.0f}) {
      for (const bool refraction : {false, true}) {
        CAPTURE(opacity);
        CAPTURE(roughness);
        CAPTURE(refraction);
        Material material = glass(opacity);
        material.roughness = roughness;
        Scene scene = card(material);
        scene.lights = {dome({1, 1, 1})};
        Estimates white;
        const Image image = render(scene, settings(64, 1, refraction));
        for (std::size_t i = 0; i < image.rgba.size(); i += 4) white.add(double(image.rgba[i]));
        white.check(1.0, 0.01);  // by what tables have
      }
    }
  }
}

TEST_CASE("a shadow ray is left what a pane does not reflect; what is bent does not arrive") {
  Scene scene = card({.name = "/floor", .diffuse_color = {1, 1, 1}});
  scene.lights = {sun({0, 0, 1})};
  const float open = channel(render(scene, settings(4, 0)), 16, 16, 0);
  scene.materials.push_back(glass());
  // Not in the camera's way: it looks from z = 100.
  add(scene, polygon({rectangle(-100, -100, 200, 200, 150)}));
  scene.meshes[1].material = 1;
  CHECK(channel(render(scene, settings(4, 0)), 16, 16, 0) == doctest::Approx(0.96f * open).epsilon(2e-3));
  scene.materials[1].opacity = 0.5f;
  CHECK(channel(render(scene, settings(4, 0)), 16, 16, 0) == doctest::Approx(0.48f * open).epsilon(2e-3));
  CHECK(channel(render(scene, settings(4, 0, true)), 16, 16, 0) == 0.0f);
  scene.materials[1].transparent_reflects = false;  // a presence bends nothing
  CHECK(channel(render(scene, settings(4, 0, true)), 16, 16, 0) == doctest::Approx(0.5f * open));
}

// Red on the left, blue on the right, far behind; the camera looks through the ball.
Scene ball_before_halves(float ior) {
  Material material = glass();
  material.ior = ior;
  Scene scene = ball(material);
  scene.materials.push_back({.name = "/red", .diffuse_color = {}, .emissive_color = {1, 0, 0}});
  scene.materials.push_back({.name = "/blue", .diffuse_color = {}, .emissive_color = {0, 0, 1}});
  add(scene, polygon({rectangle(-900, -900, 16, 900, -60)}));
  add(scene, polygon({rectangle(16, -900, 900, 900, -60)}));
  scene.meshes[0].material = 1;
  scene.meshes[1].material = 2;
  std::ranges::sort(scene.world);
  return scene;
}

TEST_CASE("a ball of glass turns the picture behind it round; one of an ior of 1 bends nothing") {
  const Image straight = render(ball_before_halves(1.5f), settings(16, 4));
  CHECK(channel(straight, 9, 16, 0) > 0.7f);
  CHECK(channel(straight, 23, 16, 2) > 0.7f);
  const Image bent = render(ball_before_halves(1.5f), settings(16, 4, true));
  CHECK(channel(bent, 9, 16, 2) > 0.7f);
  CHECK(channel(bent, 9, 16, 0) < 0.2f);
  CHECK(channel(bent, 23, 16, 0) > 0.7f);
  CHECK(channel(bent, 16, 16, kAlpha) == 1.0f);
  CHECK(channel(bent, 1, 1, 0) == 1.0f);  // beside it
  const Scene air = ball_before_halves(1.0f);
  CHECK(render(air, settings(16, 4, true)).rgba == render(air, settings(16, 4)).rgba);
}

TEST_CASE("a ball of glass in a white furnace is white") {
  Scene scene = ball(glass());
  scene.lights = {dome({1, 1, 1})};
  Estimates white;
  const Image image = render(scene, settings(64, 16, true));
  for (std::uint32_t y = 4; y < 28; ++y) {
    for (std::uint32_t x = 10; x < 22; ++x) white.add(double(channel(image, x, y, 0)));
  }
  white.check(1.0, 4e-3);
}

TEST_CASE("a normal that is constant is bent along st, and nowhere without it") {
  Material material{.name = "/bumped", .diffuse_color = {1, 1, 1}};
  material.normal = {0.6f, 0.0f, 0.8f};
  material.normal_coordinates = 0;
  Scene scene = card(material);
  scene.primvar_names = {"st", "bumps"};
  scene.lights = {sun({0.6f, 0, 0.8f})};
  const auto lit = [&] { return double(channel(render(scene, settings(4, 0)), 16, 16, 0)) * double(kPi); };
  CHECK(lit() == doctest::Approx(0.8).epsilon(1e-4));  // no st
  SurfacePrimvar st{0, {Interpolation::kVertex, 0, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}};
  scene.meshes[0].primvars = {st};
  CHECK(lit() == doctest::Approx(1.0).epsilon(1e-4));
  for (Vec3f& at : st.primvar.values) at.x = -at.x;  // s runs the other way
  scene.meshes[0].primvars = {st};
  CHECK(lit() == doctest::Approx(0.64 - 0.36).epsilon(1e-3));
  SUBCASE("by a primvar, which comes before the constant") {
    scene.materials[0].driven = {{SurfaceInput::kNormal, DrivenInput::Source::kPrimvar, 1, 0, false}};
    CHECK(lit() == doctest::Approx(0.28).epsilon(1e-3));  // not on the mesh
    scene.meshes[0].primvars.push_back({1, {Interpolation::kConstant, 0, {{-0.6f, 0.0f, 0.8f}}}});
    CHECK(lit() == doctest::Approx(1.0).epsilon(1e-4));
  }
}

Curves thick_hair(CurveShape shape) {
  Curves hair;
  hair.shape.name = "/hair";
  hair.shape.shape = shape;
  hair.shape.vertex_count = 4;
  for (int i = 0; i < 4; ++i) hair.shape.vertices.push_back({{16, -50.0f + 40.0f * float(i), 0}, 9.0f});
  hair.shape.spans = {0};
  hair.fibre = true;
  hair.display_color.values = {{1, 1, 1}};
  return hair;
}

TEST_CASE("a hair that is half there takes half of the light and bends none") {
  for (const bool refraction : {false, true}) {
    Scene scene;
    scene.camera = pixel_camera(kSize, kSize);
    scene.materials = {glass(0.5f)};
    scene.materials[0].roughness = 0.4f;
    scene.curves = {thick_hair(CurveShape::kTube)};
    scene.curves[0].material = 0;
    scene.world = {curves_id(0)};
    scene.lights = {dome({1, 1, 1})};
    RenderSettings asked = settings(256, 2, refraction);
    asked.show_domes = true;
    const Image image = render(scene, asked);
    Estimates white, half;
    for (std::uint32_t y = 0; y < kSize; ++y) {
      white.add(double(channel(image, 16, y, 0)));
      half.add(double(channel(image, 16, y, 3)));
    }
    white.check(1.0, 5e-3);
    half.check(0.5, 5e-3);
  }
}

TEST_CASE("light from behind a hair is the same from a mesh as from a rect") {
  std::array<double, 2> means{};
  for (const bool meshed : {false, true}) {
    Scene scene;
    scene.camera = pixel_camera(kSize, kSize);
    scene.curves = {thick_hair(CurveShape::kTube)};
    scene.world = {curves_id(0)};
    Light& light = scene.lights.emplace_back();
    light.radiance = {1, 1, 1};
    light.name = "/lamp";
    if (meshed) {
      Mesh& panel = scene.meshes.emplace_back();
      panel.shape.name = "/panel";
      panel.shape.vertex_count = 4;
      panel.shape.positions = {
          {-1984, -1984, -2000}, {2016, -1984, -2000}, {2016, 2016, -2000}, {-1984, 2016, -2000}, {}};
      panel.shape.triangles = {{0, 1, 2}, {0, 2, 3}};
      scene.world.insert(scene.world.begin(), mesh_id(0));
      light.kind = LightKind::kMesh;
      light.surface = {.mesh = 0};
    } else {
      light.kind = LightKind::kRect;
      light.width = light.height = 4000;
      light.world_from_light = {Affine3f{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {16, 16, -2000}}};
    }
    const Image image = render(scene, settings(128, 0));
    for (std::uint32_t y = 0; y < kSize; ++y) {
      for (const std::uint32_t x : {12u, 14u, 16u, 18u}) means[meshed] += channel(image, x, y, 0);
    }
  }
  CHECK(means[0] > 1.0);
  CHECK(means[1] == doctest::Approx(means[0]).epsilon(0.01));
}

TEST_CASE("a white hair in a white furnace is white, round or flat; as plain lobes it is not") {
  for (const CurveShape shape : {CurveShape::kRibbon, CurveShape::kTube}) {
    Scene scene;
    scene.camera = pixel_camera(kSize, kSize);
    scene.curves = {thick_hair(shape)};
    scene.world = {curves_id(0)};
    scene.lights = {dome({1, 1, 1})};
    const Image image = render(scene, settings(256, 2));
    for (const std::uint32_t x : {9u, 12u, 16u, 20u}) {
      Estimates white;
      for (std::uint32_t y = 0; y < kSize; ++y) white.add(double(channel(image, x, y, 0)));
      CAPTURE(x);
      white.check(1.0, 2e-3);
    }
    scene.lights = {sun({0, 0, -1})};  // from behind
    scene.camera.far_clip = 1e6f;
    CHECK(mean_of(render(scene, settings(16, 0)), 0) > 0.01);
    scene.curves[0].fibre = false;
    CHECK(mean_of(render(scene, settings(16, 0)), 0) == 0.0);
  }
}

}  // namespace
}  // namespace msbvh
