// A sequence of frames on one Renderer: the pictures do not depend on what trees take over from each other.
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 40;
constexpr int kFrames = 5;

RenderSettings settings_for(Refit refit) {
  RenderSettings settings{.width = kSize, .height = kSize, .spp = 4, .max_bounces = 1, .build = {}};
  settings.build.refit = refit;
  settings.build.keep_topology = true;
  return settings;
}

InstanceSet placed(const char* name, std::uint32_t prototype, std::vector<Affine3f> maps) {
  InstanceSet set;
  set.name = name;
  set.prototype = prototype;
  set.segments = 1;
  set.world_from_prototype = std::move(maps);
  return set;
}

// A cube that grows, instances of a still one, of one that swells, and of one that is there now and then.
Scene scene_at(int frame) {
  const float f = static_cast<float>(frame);
  const auto scaled = [](float s, const Vec3f& t) {
    return Affine3f{{s, 0, 0}, {0, s, 0.1f * s}, {0, 0, s}, t};
  };
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  scene.lights = {dome({0.3f, 0.4f, 0.5f})};
  const auto add_mesh = [&scene](Mesh mesh, const char* name) {
    mesh.shape = validated(std::move(mesh.shape));
    mesh.shape.name = name;
    scene.meshes.push_back(std::move(mesh));
    return mesh_id(static_cast<std::uint32_t>(scene.meshes.size() - 1));
  };
  scene.world = {add_mesh(baked(cube(), {scaled(3 + f, {20, 20, 0}), scaled(4 + f, {22, 20, 0})}), "/grows")};
  if (frame % 2) scene.prototypes.push_back({"/now_and_then", {add_mesh(cube(), "/now_and_then/cube")}});
  const auto first = static_cast<std::uint32_t>(scene.prototypes.size());
  scene.prototypes.push_back({"/still", {add_mesh(baked(cube(), std::vector<Affine3f>(9)), "/still/cube")}});
  scene.prototypes.push_back(
      {"/swells", {add_mesh(baked(cube(), {scaled(1 + f, {}), scaled(2 + f, {})}), "/swells/cube")}});
  scene.instances = {placed("/still", first, {scaled(4, {8, 8, 0}), scaled(4, {9 + f, 8, 0})}),
                     placed("/swells", first + 1, {scaled(1, {30, 10, 9}), scaled(1, {30, 10 + f, 9})})};
  if (frame % 2)
    scene.instances.push_back(placed("/now", 0, {scaled(3, {10, 32, 0}), scaled(3, {14, 32, 0})}));
  return scene;
}

TEST_CASE("frames are the same, bit for bit, however their trees come about") {
  Renderer automatic, always;
  for (int frame = 0; frame < kFrames; ++frame) {
    CAPTURE(frame);
    const auto scene = std::make_shared<const Scene>(scene_at(frame));
    Renderer never;
    never.commit(scene, settings_for(Refit::kNever));
    const Image expected = never.render();
    for (Renderer* renderer : {&automatic, &always}) {
      renderer->commit(scene, settings_for(renderer == &always ? Refit::kAlways : Refit::kAuto));
      renderer->verify();
      CHECK(renderer->render().rgba == expected.rgba);
    }
    const BvhStatistics& s = always.statistics().accel;
    CHECK(s.built + s.refitted + s.kept == always.statistics().trees);
    CHECK(s.kept == (frame == 0 ? 0 : 1));  // the still prototype, whatever its index
    CHECK(s.refitted ==
          (frame == 0 ? 0 : 1));  // the one that swells; the world has other instances each time
  }
}

TEST_CASE("a frame again is kept whole") {
  Renderer renderer;
  const auto scene = std::make_shared<const Scene>(scene_at(1));
  renderer.commit(scene, settings_for(Refit::kAuto));
  const Image first = renderer.render();
  renderer.commit(std::make_shared<const Scene>(scene_at(1)), settings_for(Refit::kAuto));
  CHECK(renderer.statistics().accel.kept == renderer.statistics().trees);
  CHECK(renderer.render().rgba == first.rgba);
  renderer.commit(scene, settings_for(Refit::kNever));
  CHECK(renderer.statistics().accel.built == renderer.statistics().trees);
}

TEST_CASE("a commit that fails leaves the last frame") {
  Renderer renderer;
  renderer.commit(std::make_shared<const Scene>(scene_at(1)), settings_for(Refit::kAuto));
  const Image first = renderer.render();
  RenderSettings cancelled = settings_for(Refit::kAuto);
  cancelled.build.cancelled = [] { return true; };
  CHECK_THROWS(renderer.commit(std::make_shared<const Scene>(scene_at(2)), cancelled));
  CHECK(renderer.render().rgba == first.rgba);
}

}  // namespace
}  // namespace msbvh
