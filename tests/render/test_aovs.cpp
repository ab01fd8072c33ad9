// What pixels tell beside their colour.
#include <limits>

#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

// All but the one that no two runs have alike.
std::vector<Aov> all_that_repeat() {
  std::vector<Aov> aovs;
  for (std::size_t i = 0; i < kAovCount; ++i) {
    if (Aov(i) != Aov::kSeconds) aovs.push_back(Aov(i));
  }
  return aovs;
}
const std::vector<Aov> kAll = all_that_repeat();

Image render_all(const Scene& scene, std::uint32_t width, std::uint32_t height, std::uint32_t spp) {
  return render(scene,
                {.width = width, .height = height, .spp = spp, .max_bounces = 0, .aovs = kAll, .build = {}});
}

const AovImage& layer(const Image& image, Aov aov) {
  return *std::ranges::find(image.aovs, aov, &AovImage::aov);
}
float value(const Image& image, Aov aov, std::size_t pixel, std::size_t channel = 0) {
  return layer(image, aov).values[pixel * form_of(aov).numbers + channel];
}
std::int32_t id(const Image& image, Aov aov, std::size_t pixel) { return layer(image, aov).ids[pixel]; }

// A wall of two quads at z = 20 over pixels 0 and 1, and an instance at z = 60 over pixel 2; pixel 3 is
// empty.
Scene wall_and_instance() {
  Scene scene;
  scene.camera = pixel_camera(4, 1);
  scene.camera.far_clip = 200.0f;
  Mesh wall = polygon({rectangle(0, 0, 2, 1, 20.0f)});
  wall.display_color.values = {{0.25f, 0.5f, 0.75f}};
  wall.triangle_faces = {7, 7};
  add(scene, wall);
  Mesh thing = polygon({rectangle(0, 0, 1, 1, 0.0f)});
  thing.display_color.values = {{1, 1, 1}};
  thing.prim_id = 41;
  add_instance(scene, thing, {translation({2, 0, 60})});
  return scene;
}

TEST_CASE("each output by its meaning; -1, 0 and infinity where nothing is") {
  const Image image = render_all(wall_and_instance(), 4, 1, 8);
  CHECK(value(image, Aov::kCameraDepth, 0) == 80.0f);
  CHECK(value(image, Aov::kDepth, 0) == doctest::Approx(80.0 / 200.0));
  CHECK(value(image, Aov::kCameraDepth, 2) == 40.0f);
  CHECK(value(image, Aov::kCameraDepth, 3) == std::numeric_limits<float>::infinity());
  CHECK(value(image, Aov::kDepth, 3) == 1.0f);
  CHECK(id(image, Aov::kPrimId, 1) == 0);
  CHECK(id(image, Aov::kPrimId, 2) == 41);
  CHECK(id(image, Aov::kPrimId, 3) == -1);
  CHECK(id(image, Aov::kInstanceId, 1) == -1);
  CHECK(id(image, Aov::kInstanceId, 2) == 0);
  CHECK(id(image, Aov::kElementId, 1) == 7);
  CHECK(id(image, Aov::kElementId, 3) == -1);
  const float albedo[] = {0.25f, 0.5f, 0.75f}, towards[] = {0, 0, 1};
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(value(image, Aov::kAlbedo, 0, c) == albedo[c]);
    CHECK(value(image, Aov::kNormal, 0, c) == towards[c]);
    CHECK(value(image, Aov::kNeye, 0, c) == towards[c]);
    CHECK(value(image, Aov::kAlbedo, 3, c) == 0.0f);
  }
}

TEST_CASE("an instance has the number that its instancer gives it") {
  Scene scene = wall_and_instance();
  scene.instances[0].ids = {12};
  CHECK(id(render_all(scene, 4, 1, 4), Aov::kInstanceId, 2) == 12);
  scene.instances[0].ids = {-1};  // a prim that merely moves
  CHECK(id(render_all(scene, 4, 1, 4), Aov::kInstanceId, 2) == -1);
}

TEST_CASE("normals in the camera's space follow the camera") {
  Scene scene;
  scene.camera = pixel_camera(1, 1);
  // Looks along +x, its y up: sees the wall x = 5 from -x.
  scene.camera.world_from_camera = {Affine3f{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}, {-10, 0, 0}}};
  add(scene, polygon({{{5, -9, -9}, {5, 9, -9}, {5, 9, 9}, {5, -9, 9}}}));
  const Image image = render_all(scene, 1, 1, 1);
  CHECK(value(image, Aov::kNormal, 0, 0) == doctest::Approx(-1.0));
  CHECK(value(image, Aov::kNeye, 0, 2) == doctest::Approx(1.0));
}

TEST_CASE("perspective depth is OpenGL's") {
  Scene scene = wall_and_instance();
  scene.camera.projection = Projection::kPerspective;
  scene.camera.world_from_camera = {translation({1, 0.5f, 100})};
  scene.camera.window = {{-0.001f, 0.001f, -0.001f, 0.001f}};
  scene.camera.near_clip = 10.0f;
  const Image image = render_all(scene, 1, 1, 1);
  CHECK(value(image, Aov::kCameraDepth, 0) == doctest::Approx(80.0));
  CHECK(value(image, Aov::kDepth, 0) == doctest::Approx(200.0 / 190.0 * (1.0 - 10.0 / 80.0)));
}

TEST_CASE("of a pixel that several surfaces share, ids and depth are the nearest's, the rest a mean") {
  Scene scene;
  scene.camera = pixel_camera(1, 1);
  Mesh near_quarter = polygon({rectangle(0, 0, 0.25f, 1, 50.0f)}),
       far_wall = polygon({rectangle(0, 0, 1, 1, 0.0f)});
  near_quarter.display_color.values = {{1, 1, 1}};
  far_wall.display_color.values = {{0, 0, 0}};
  add(scene, far_wall);
  add(scene, near_quarter);
  const Image image = render_all(scene, 1, 1, 64);
  CHECK(id(image, Aov::kPrimId, 0) == 1);
  CHECK(value(image, Aov::kCameraDepth, 0) == doctest::Approx(50.0));
  CHECK(value(image, Aov::kAlbedo, 0) == 0.25f);  // a (0,6,2)-net: a quarter of the samples to the sample
}

TEST_CASE("outputs change neither colour nor each other, and batches and threads change no bit of them") {
  const Scene scene = wall_and_instance();
  RenderSettings settings{.width = 4, .height = 1, .spp = 40, .max_bounces = 1, .build = {}};
  const Image plain = render(scene, settings);
  CHECK(plain.aovs.empty());
  settings.aovs = kAll;
  const Image all = render(scene, settings);
  CHECK(all.rgba == plain.rgba);
  settings.batch_paths = 1;
  settings.threads = 1;
  const Image again = render(scene, settings);
  for (std::size_t i = 0; i < kAll.size(); ++i) {
    CHECK(again.aovs[i].values == all.aovs[i].values);
    CHECK(again.aovs[i].ids == all.aovs[i].ids);
  }
  settings.aovs = {Aov::kSeconds};
  const Image timed = render(scene, settings);
  CHECK(timed.rgba == plain.rgba);
  for (const float seconds : timed.aovs[0].values) CHECK(seconds > 0.0f);
}

}  // namespace
}  // namespace msbvh
