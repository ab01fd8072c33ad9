// Sampling a frame's stages: the same picture, and none but the stages that the scene calls for.
#include "core/plan/effect_plan.h"
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 64;

Scene lit_square() {
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  add(scene, polygon({rectangle(0, 0, kSize, kSize)}));
  scene.lights = {dome({1, 1, 1})};
  return scene;
}

TEST_CASE("sampling stages does not change the picture, and finds the stages that are on") {
  RenderSettings settings{.width = kSize, .height = kSize, .spp = 256, .max_bounces = 0, .build = {}};
  Renderer renderer;
  const auto scene = std::make_shared<const Scene>(lit_square());
  renderer.commit(scene, settings);
  const Image plain = renderer.render();
  CHECK(renderer.statistics().stages.total() == 0);
  settings.sample_stages = true;
  renderer.commit(scene, settings);
  CHECK(renderer.render().rgba == plain.rgba);
  const StageCounts& found = renderer.statistics().stages;
  CHECK(found.total() > 0);
  for (std::size_t code = 0; code < found.of_code.size(); ++code) {
    const StageNow now = StageNow::of(code);
    if (now.stage == Stage::kOpacity || now.stage == Stage::kAovs || now.stage == Stage::kAreaLights ||
        now.bounced)
      CHECK(found.of_code[code] == 0);
  }
}

TEST_CASE("lights without a place, and single values, do not make a light move") {
  Scene scene = lit_square();
  scene.lights = {camera_light()};
  const RenderSettings settings{.width = kSize, .height = kSize, .spp = 1, .max_bounces = 0, .build = {}};
  const Image still = render(scene, settings);
  scene.lights[0].segments = 1;
  scene.lights[0].world_from_light = {Affine3f{}, translation({1, 2, 3})};
  CHECK(render(scene, settings).rgba == still.rgba);
  scene.lights[0].segments = 0;
  scene.lights[0].world_from_light = {Affine3f{}};
  scene.lights[0].moving_values = {scene.lights[0]};
  CHECK(render(scene, settings).rgba == still.rgba);
}

}  // namespace
}  // namespace msbvh
