// The renderer as its callers see it: progress, cancellation, errors, figures.
#include <chrono>
#include <thread>

#include "core/base/error.h"
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

Scene quad_scene() {
  Scene scene;
  scene.camera = pixel_camera(64, 64);
  scene.lights = {camera_light()};
  add(scene, polygon({rectangle(-1, -1, 65, 65)}));
  return scene;
}

const RenderSettings kLong{.width = 64, .height = 64, .spp = 1 << 20, .max_bounces = 2, .build = {}};

TEST_CASE("progress comes on the caller's thread and grows; false cancels at once") {
  Renderer renderer;
  renderer.commit(std::make_shared<Scene>(quad_scene()), kLong);
  const auto caller = std::this_thread::get_id();
  int calls = 0;
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(renderer.render([&](double share) {
    CHECK(std::this_thread::get_id() == caller);
    CHECK(share >= 0.0);
    CHECK(share < 1.0);
    return ++calls < 3;
  }),
                  Cancelled);
  CHECK(calls == 3);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
}

TEST_CASE("what the progress function throws stops the rendering and comes through") {
  Renderer renderer;
  renderer.commit(std::make_shared<Scene>(quad_scene()), kLong);
  CHECK_THROWS_AS(renderer.render([](double) -> bool { throw std::string("mine"); }), std::string);
}

TEST_CASE("the last progress is 1") {
  RenderSettings settings = kLong;
  settings.spp = 4;
  Renderer renderer;
  renderer.commit(std::make_shared<Scene>(quad_scene()), settings);
  double last = -1.0;
  renderer.render([&](double share) {
    last = share;
    return true;
  });
  CHECK(last == 1.0);
}

TEST_CASE("a build can be cancelled") {
  RenderSettings settings = kLong;
  settings.build.cancelled = [] { return true; };
  Renderer renderer;
  CHECK_THROWS_AS(renderer.commit(std::make_shared<Scene>(quad_scene()), settings), Cancelled);
}

TEST_CASE("figures: rays of each kind, trees, triangles") {
  RenderSettings settings{.width = 8, .height = 8, .spp = 4, .max_bounces = 0, .build = {}};
  Renderer renderer;
  Scene scene = quad_scene();
  scene.camera = pixel_camera(8, 8);
  scene.lights = {dome({1, 1, 1})};
  add_instance(scene, cube(), {translation({0, 0, -100})});
  renderer.commit(std::make_shared<Scene>(scene), settings);
  renderer.render();
  const RenderStatistics& figures = renderer.statistics();
  CHECK(figures.camera_rays == 8 * 8 * 4);
  CHECK(figures.rays.rays() == 2 * 8 * 8 * 4);  // each with one shadow ray towards the dome
  CHECK(figures.trees == 2);
  CHECK(figures.accel.triangles == 2 + 12);
  CHECK(figures.accel.instances == 1);
}

TEST_CASE("a scene without geometry is empty, or all dome") {
  Scene scene;
  scene.camera = pixel_camera(4, 4);
  const RenderSettings settings{.width = 4, .height = 4, .spp = 1, .build = {}};
  CHECK(render(scene, settings).rgba == std::vector<float>(64, 0.0f));
  scene.lights = {dome({2, 2, 2})};
  scene.prototypes = {{"/empty", {}}};
  scene.instances = {{"/instance", 0, 0, {Affine3f{}}, {}}};
  const Image image = render(scene, settings);
  CHECK(channel(image, 2, 2, 0) == 2.0f);
  CHECK(channel(image, 2, 2, kAlpha) == 0.0f);
}

TEST_CASE("the clipping range cuts camera rays") {
  Scene scene = quad_scene();  // the quad lies at a distance of 100
  const RenderSettings settings{.width = 64, .height = 64, .spp = 1, .max_bounces = 0, .build = {}};
  CHECK(channel(render(scene, settings), 9, 9, kAlpha) == 1.0f);
  scene.camera.near_clip = 101.0f;
  CHECK(channel(render(scene, settings), 9, 9, kAlpha) == 0.0f);
  scene.camera.near_clip = 1.0f;
  scene.camera.far_clip = 99.0f;
  CHECK(channel(render(scene, settings), 9, 9, kAlpha) == 0.0f);
}

TEST_CASE("settings out of range and broken scenes are errors in one line") {
  const auto complaint = [](const Scene& scene, const RenderSettings& settings) -> std::string {
    try {
      Renderer().commit(std::make_shared<Scene>(scene), settings);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const Scene scene = quad_scene();
  CHECK(complaint(scene, {.width = 0, .build = {}}) ==
        "render settings: width: found 0; expected 1 to 65536");
  CHECK(complaint(scene, {.spp = 0, .build = {}}) == "render settings: spp: found 0; expected 1 to 1048576");
  Scene broken = scene;
  broken.meshes[0].shape.triangles[1][0] = 17;
  CHECK(complaint(broken, {}) == "/polygon: triangles: triangle 1 uses vertex 17; expected less than 4");
  broken = scene;
  broken.meshes[0].display_color.values.resize(3);
  CHECK(complaint(broken, {}) == "/polygon: displayColor: found 3 values; expected 1 keys x 1");
  CHECK_THROWS_AS(Renderer().render(), Error);
  CHECK_THROWS_AS(Renderer().plan(), Error);
  CHECK_THROWS_AS(Renderer().statistics(), Error);
  CHECK_THROWS_AS(Renderer().verify(), Error);
  CHECK_THROWS_AS(Renderer().commit(nullptr, {}), Error);
}

TEST_CASE("a renderer whose first commit failed has nothing to render; a later one keeps the last frame") {
  RenderSettings settings{.width = 4, .height = 4, .spp = 1, .max_bounces = 0, .build = {}};
  RenderSettings cancelled = settings;
  cancelled.build.cancelled = [] { return true; };
  Renderer renderer;
  CHECK_THROWS_AS(renderer.commit(std::make_shared<Scene>(quad_scene()), cancelled), Cancelled);
  CHECK_THROWS_AS(renderer.render(), Error);
  renderer.commit(std::make_shared<Scene>(quad_scene()), settings);
  const Image image = renderer.render();
  CHECK_THROWS_AS(renderer.commit(std::make_shared<Scene>(quad_scene()), cancelled), Cancelled);
  CHECK(renderer.render().rgba == image.rgba);
}

TEST_CASE("a scene without anything in it renders to nothing") {
  Scene scene;
  scene.camera = pixel_camera(4, 4);
  for (const float value : render(scene, {.width = 4, .height = 4, .spp = 1, .build = {}}).rgba) {
    CHECK(value == 0.0f);
  }
}

}  // namespace
}  // namespace msbvh
