// What a scene does not call for costs no ray: counted, not timed, and with the same bits.
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

const RenderSettings kSmall{.width = 32, .height = 32, .spp = 8, .max_bounces = 2, .build = {}};

// Two bodies, so that bounces of one could meet the other.
Scene bodies() {
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  add(scene, baked(cube(), {{{8, 3, 2}, {-3, 7, 4}, {1, -4, 8}, {10, 16, 0}}}));
  add(scene, polygon({rectangle(0, 0, 32, 32, -20)}));
  return scene;
}

struct Rendered {
  Image image;
  std::uint64_t rays;
  std::uint64_t camera_rays;
};

Rendered rendered(const Scene& scene, const RenderSettings& settings) {
  Renderer renderer;
  renderer.commit(std::make_shared<const Scene>(scene), settings);
  Image image = renderer.render();
  return {std::move(image), renderer.statistics().rays.rays(), renderer.statistics().camera_rays};
}

Light black(LightKind kind) {
  Light light;
  light.name = "/black";
  light.kind = kind;
  light.radiance = {};
  light.world_from_light = {translation({16, 16, 50})};
  return light;
}

TEST_CASE("without light, paths end at the first surface") {
  const Scene scene = bodies();
  RenderSettings settings = kSmall;
  settings.aovs = {Aov(0)};
  const Rendered found = rendered(scene, settings);
  CHECK(found.rays == found.camera_rays);
  settings.max_bounces = 0;
  const Rendered direct = rendered(scene, settings);
  CHECK(found.image.rgba == direct.image.rgba);
}

TEST_CASE("black lights cost no ray and change no bit") {
  Scene scene = bodies();
  for (const LightKind kind : {LightKind::kDistant, LightKind::kDome, LightKind::kSphere, LightKind::kRect}) {
    scene.lights = {black(kind)};
    const Rendered alone = rendered(scene, kSmall);
    CHECK(alone.rays == alone.camera_rays);
  }
  scene.lights = {dome({1, 1, 1})};
  const Rendered lit = rendered(scene, kSmall);
  CHECK(lit.rays > lit.camera_rays);
  scene.lights.push_back(black(LightKind::kRect));
  scene.lights.push_back(black(LightKind::kSphere));
  const Rendered beside = rendered(scene, kSmall);
  CHECK(beside.rays == lit.rays);
  CHECK(beside.image.rgba == lit.image.rgba);
}

TEST_CASE("a surface that glows is still seen by bounces") {
  Scene scene = bodies();
  scene.materials.resize(1);
  scene.materials[0].emissive_color = {1, 2, 3};
  scene.meshes[0].material = 0;
  const Rendered found = rendered(scene, kSmall);
  CHECK(found.rays > found.camera_rays);
  RenderSettings direct = kSmall;
  direct.max_bounces = 0;
  CHECK(found.image.rgba != rendered(scene, direct).image.rgba);
}

}  // namespace
}  // namespace msbvh
