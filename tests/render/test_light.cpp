// Radiance against closed forms.
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

const RenderSettings kSmall{.width = 32, .height = 32, .spp = 16, .max_bounces = 0, .build = {}};

Affine3f posed_cube(const Vec3f& place) { return {{8, 3, 2}, {-3, 7, 4}, {1, -4, 8}, place}; }

// Furnace: nothing hides the dome from a convex body, so that each of its samples has the radiance albedo *
// dome, and all others see the dome itself. No variance: one ray that hits its own surface shows.
void check_furnace(const Scene& scene, const RenderSettings& settings) {
  const Image image = render(scene, settings);
  double coverage = 0;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const float alpha = channel(image, x, y, kAlpha);
      coverage += alpha;
      CHECK(channel(image, x, y, 0) == doctest::Approx(0.5 * 2.0 * alpha + 2.0 * (1 - alpha)).epsilon(1e-5));
      CHECK(channel(image, x, y, 1) == doctest::Approx(0.25 * alpha + (1 - alpha)).epsilon(1e-5));
    }
  }
  CHECK(coverage > 0.2 * image.width * image.height);
  CHECK(coverage < 0.9 * image.width * image.height);
}

TEST_CASE("furnace: a convex body in a constant dome") {
  Mesh body = cube();
  body.display_color.values = {{0.5f, 0.25f, 0.1f}};
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  scene.lights = {dome({2, 1, 0})};
  RenderSettings settings = kSmall;
  SUBCASE("still") { add(scene, baked(body, {posed_cube({16, 16, 0})})); }
  SUBCASE("moving vertices") {
    add(scene, baked(body, {posed_cube({10, 16, 0}), posed_cube({16, 16, 0}), posed_cube({20, 20, 5})}));
  }
  SUBCASE("moving instance") {
    add_instance(scene, body, {posed_cube({10, 16, 0}), posed_cube({22, 16, 0})});
  }
  SUBCASE("the bounce meets the dome") {
    settings.max_bounces = 3;
    add(scene, baked(body, {posed_cube({16, 16, 0})}));
  }
  SUBCASE("1e4 away") {
    const Vec3f far{1e4f, -1e4f, 1e4f};
    scene.camera.world_from_camera[0].t += far;
    add_instance(scene, body, {posed_cube(far + Vec3f{10, 16, 0}), posed_cube(far + Vec3f{22, 16, 0})});
  }
  check_furnace(scene, settings);
}

TEST_CASE("domes that are not shown light the scene all the same") {
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  scene.lights = {dome({2, 1, 0})};
  Mesh body = cube();
  body.display_color.values = {{0.5f, 0.25f, 0.1f}};
  add(scene, baked(body, {posed_cube({16, 16, 0})}));
  RenderSettings settings = kSmall;
  settings.show_domes = false;
  SUBCASE("opaque") {}
  SUBCASE("the bounce meets the dome") { settings.max_bounces = 1; }
  const Image image = render(scene, settings);
  CHECK(channel(image, 0, 0, 0) == 0.0f);
  CHECK(channel(image, 16, 16, 0) == doctest::Approx(1.0).epsilon(1e-5));
}

TEST_CASE("furnace: in a closed, emitting room every bounce adds the albedo's next power") {
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  scene.camera.projection = Projection::kPerspective;
  scene.camera.world_from_camera = {translation({0.1f, 0.2f, 0.3f})};
  scene.camera.window = {{-1, 1, -1, 1}};
  Mesh room = baked(cube(), {Affine3f{{8, 3, 2}, {-3, 7, 4}, {1, -4, 8}, {}}});
  room.material = 0;
  scene.materials.resize(1);
  scene.materials[0].diffuse_color = {0.5f, 0.25f, 0.0f};
  scene.materials[0].emissive_color = {1, 2, 3};
  add(scene, room);
  for (const std::uint32_t bounces : {0u, 1u, 4u}) {
    RenderSettings settings = kSmall;
    settings.max_bounces = bounces;
    const Image image = render(scene, settings);
    double red = 0, green = 0;
    for (std::uint32_t i = 0; i <= bounces; ++i) {
      red += std::pow(0.5, i);
      green += 2 * std::pow(0.25, i);
    }
    for (std::uint32_t i = 0; i < 32 * 32; ++i) {
      REQUIRE(image.rgba[4 * i] == doctest::Approx(red).epsilon(1e-5));
      REQUIRE(image.rgba[4 * i + 1] == doctest::Approx(green).epsilon(1e-5));
      REQUIRE(image.rgba[4 * i + 2] == 3.0f);
      REQUIRE(image.rgba[4 * i + kAlpha] == 1.0f);
    }
  }
}

TEST_CASE("the camera light shows the albedo of what faces it, from either side of the surface") {
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  scene.camera.world_from_camera = {translation({0, 0, 1e6f})};
  scene.camera.far_clip = 1e7f;
  scene.lights = {camera_light()};
  std::vector<Vec3f> corners = rectangle(-1, -1, 33, 33);
  SUBCASE("front") {}
  SUBCASE("back") { std::reverse(corners.begin(), corners.end()); }
  add(scene, polygon({corners}));
  scene.meshes[0].display_color.values = {{0.25f, 0.5f, 0.75f}};
  const Image image = render(scene, kSmall);
  CHECK(channel(image, 16, 16, 0) == doctest::Approx(0.25).epsilon(1e-5));
  CHECK(channel(image, 16, 16, 1) == doctest::Approx(0.5).epsilon(1e-5));
  CHECK(channel(image, 16, 16, 2) == doctest::Approx(0.75).epsilon(1e-5));
}

// A floor under a distant light without extent that comes from (1, 0, 1) / sqrt(2), and a blocker beside the
// picture whose shadow falls on the part of the floor with x < 16 once it stands still, on a ramp when it
// moves.
Scene shadow_scene(const Mesh& blocker) {
  Scene scene;
  scene.camera = pixel_camera(32, 32);
  Light sun;
  sun.name = "/sun";
  sun.angle_degrees = 0.0f;
  const float h = std::sqrt(0.5f);
  sun.world_from_light = {Affine3f{{h, 0, -h}, {0, 1, 0}, {h, 0, h}, {}}};
  sun.radiance = {kPi, kPi, kPi};
  scene.lights = {sun};
  add(scene, polygon({rectangle(-100, -100, 200, 200)}));
  scene.meshes[0].display_color.values = {{0.5f, 0.5f, 0.5f}};
  add(scene, blocker);
  return scene;
}
constexpr float kHeight = 50.0f;  // of the blocker; its shadow falls this far to the left of it

TEST_CASE("a distant light and a shadow") {
  const Image image =
      render(shadow_scene(polygon({rectangle(40, -100, 16 + kHeight, 200, kHeight)})), kSmall);
  CHECK(channel(image, 15, 16, 0) == 0.0f);
  CHECK(channel(image, 16, 16, 0) == doctest::Approx(0.5 * std::sqrt(0.5)).epsilon(1e-5));
}

TEST_CASE("a moving shadow is cast at the time of the sample") {
  constexpr float kOpen = 5.5f, kClose = 26.0f;
  const Scene scene = shadow_scene(polygon({rectangle(40, -100, kOpen + kHeight, 200, kHeight),
                                            rectangle(40, -100, kClose + kHeight, 200, kHeight)}));
  RenderSettings settings = kSmall;
  settings.spp = 64;
  const Image image = render(scene, settings);
  for (std::uint32_t x = 0; x < 32; ++x) {
    Estimates column;
    for (std::uint32_t y = 0; y < 32; ++y) column.add(channel(image, x, y, 0));
    column.check((1 - swept(x, kOpen, kClose)) * 0.5 * std::sqrt(0.5), 1e-5);
  }
}

TEST_CASE("a sphere light at the foot of its perpendicular") {
  Scene scene;
  scene.camera = pixel_camera(1, 1);
  scene.camera.window = {{-0.01f, 0.01f, -0.01f, 0.01f}};
  scene.camera.world_from_camera = {translation({0, 0, 1})};
  Light light;
  light.kind = LightKind::kSphere;
  light.radius = 1.0f;
  light.radiance = {4, 4, 4};
  light.world_from_light = {translation({0, 0, 3})};
  scene.lights = {light};
  add(scene, polygon({rectangle(-9, -9, 9, 9)}));
  scene.meshes[0].display_color.values = {{0.5f, 0.5f, 0.5f}};
  RenderSettings settings{.width = 1, .height = 1, .spp = 256, .max_bounces = 0, .build = {}};
  Estimates pixel;
  for (settings.seed = 0; settings.seed < 32; ++settings.seed) {
    pixel.add(render(scene, settings).rgba[0]);
  }
  pixel.check(0.5 * 4.0 / 9.0, 2e-5);  // albedo / pi * pi L r^2 / d^2; the pixel is 0.02 wide
}

// A white card that fills the picture, and a light whose radiance is `first` at the shutter's opening and
// `second` at its closing.
Scene card_under(Light light, float first, float second) {
  Scene scene;
  scene.camera = pixel_camera(8, 8);
  light.segments = 1;
  light.world_from_light.resize(2, translation({4, 4, 30}));
  LightValues values = light;
  values.radiance = {first, first, first};
  light.moving_values = {values, values};
  light.moving_values[1].radiance = {second, second, second};
  scene.lights = {light};
  add(scene, polygon({rectangle(-100, -100, 200, 200)}));
  scene.meshes[0].display_color.values = {{1, 1, 1}};
  return scene;
}

double mean_red(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += image.rgba[i];
  return sum / double(image.rgba.size() / 4);
}

TEST_CASE("a light that ramps from 0 to 1 within the shutter gives half its light") {
  RenderSettings settings{.width = 8, .height = 8, .spp = 256, .max_bounces = 0, .build = {}};
  double full = 1.0;
  Light light;
  SUBCASE("distant, without an extent") {
    light.angle_degrees = 0.0f;
    full = 1.0 / kPi;
  }
  SUBCASE("distant") {
    light.angle_degrees = 90.0f;
    full = 0.5;  // sin^2 of the half angle
  }
  SUBCASE("dome") { light.kind = LightKind::kDome; }
  SUBCASE("dome, met by bounces") {
    light.kind = LightKind::kDome;
    settings.max_bounces = 2;
  }
  const Image image = render(card_under(light, 0.0f, 1.0f), settings);
  CHECK(std::abs(mean_red(image) / (0.5 * full) - 1.0) <= 0.002);
  // The mean of a linear ramp by stratified times: within a stratum of the closed form in every pixel.
  CHECK(std::abs(channel(image, 3, 3, 0) / (0.5 * full) - 1.0) <= 1.0 / 64);
}

TEST_CASE("a ramp of a light is seen by what moves: its streak shows the ramp") {
  // A thin card sweeps the picture.
  Light sun;
  sun.angle_degrees = 0.0f;
  Scene scene = card_under(sun, 0.0f, kPi);
  scene.camera = pixel_camera(32, 8);
  scene.meshes.clear();
  scene.world.clear();
  add(scene, polygon({rectangle(-2, -9, 0, 99), rectangle(32, -9, 34, 99)}));
  scene.meshes[0].display_color.values = {{1, 1, 1}};
  const Image image = render(scene, {.width = 32, .height = 8, .spp = 1024, .max_bounces = 0, .build = {}});
  for (std::uint32_t x = 2; x < 30; ++x) {
    double red = 0, alpha = 0;
    for (std::uint32_t y = 0; y < 8; ++y) {
      red += channel(image, x, y, 0);
      alpha += channel(image, x, y, kAlpha);
    }
    // The card covers [34 u - 2, 34 u]: the mean time at which it covers the pixel's centre.
    CHECK(std::abs(red / alpha - (x + 0.5 + 1.0) / 34) <= 0.003);
  }
}

// A floor under lamps of which ten are near and the rest far off or below it.
Scene floor_under(std::size_t lamps) {
  Scene scene;
  scene.camera = pixel_camera(16, 16);
  Mesh floor;
  floor.shape.name = "/floor";
  floor.shape.vertex_count = 4;
  floor.shape.positions = {{-2, -2, 0}, {18, -2, 0}, {18, 18, 0}, {-2, 18, 0}};
  floor.shape.triangles = {{0, 1, 2}, {0, 2, 3}};
  floor.display_color.values = {{0.5f, 0.5f, 0.5f}};
  add(scene, floor);
  for (std::size_t i = 0; i < lamps; ++i) {
    const Point2 place = Sampler(PixelSampler(9, std::uint32_t(i), 0), 0).pair(Dimension::kLight, 0);
    Light lamp;
    lamp.name = "/lamp";
    lamp.kind = LightKind::kSphere;
    lamp.radius = 0.2f;
    lamp.radiance = {30, 30, 30};
    Vec3f at{16.0f * place.x, 16.0f * place.y, 3.0f};
    if (i >= 10)
      at = i % 2 ? Vec3f{at.x, at.y, -3.0f} : Vec3f{300.0f * place.x + 60.0f, 300.0f * place.y, 40.0f};
    lamp.world_from_light = {translation(at)};
    scene.lights.push_back(lamp);
  }
  return scene;
}

double mean_square_error(const Scene& scene) {
  RenderSettings settings{.width = 16, .height = 16, .spp = 2048, .seed = 5, .max_bounces = 0, .build = {}};
  const Image truth = render(scene, settings);
  settings.spp = 8;
  double sum = 0.0;
  for (settings.seed = 10; settings.seed < 18; ++settings.seed) {
    const Image image = render(scene, settings);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      const double error = image.rgba[i] - truth.rgba[i];
      sum += error * error;
    }
  }
  return sum;
}

// Ten lamps under a ceiling, and the rest above it.
Scene floor_under_ceiling(std::size_t lamps) {
  Scene scene = floor_under(lamps);
  scene.camera.world_from_camera = {translation({0, 0, 3.9f})};
  add(scene, polygon({rectangle(-50, -50, 66, 66, 4)}));
  for (std::size_t i = 10; i < lamps; ++i) {
    const Point2 place = Sampler(PixelSampler(9, std::uint32_t(i), 0), 0).pair(Dimension::kLight, 0);
    scene.lights[i].world_from_light = {
        translation({16.0f * place.x, 16.0f * place.y, 5.0f + 0.01f * float(i % 100)})};
  }
  return scene;
}

// Untaught, the squared error is 1,550 times that of the ten.
TEST_CASE("a thousand lights of which a ceiling hides all but ten: it is learnt which") {
  const double few = mean_square_error(floor_under_ceiling(10)),
               many = mean_square_error(floor_under_ceiling(1000));
  CAPTURE(few);
  CAPTURE(many);
  CHECK(few > 0.0);
  CHECK(many < 8.0 * few);
}

TEST_CASE("what is learnt of lights is the same for any number of threads, and keeps the mean") {
  const Scene many = floor_under_ceiling(64);
  RenderSettings settings{.width = 16, .height = 16, .spp = 256, .max_bounces = 1, .threads = 1, .build = {}};
  const Image one = render(many, settings);
  settings.threads = 3;
  CHECK(render(many, settings).rgba == one.rgba);
  Scene few = many;
  few.lights.resize(10);
  const Image expected = render(few, settings);
  double found = 0.0, wanted = 0.0;
  for (std::size_t i = 0; i < one.rgba.size(); i += 4) {
    found += one.rgba[i];
    wanted += expected.rgba[i];
  }
  CHECK(found == doctest::Approx(wanted).epsilon(5e-3));
}

TEST_CASE("a thousand lights of which ten matter are hardly noisier than the ten alone") {
  const double few = mean_square_error(floor_under(10)), many = mean_square_error(floor_under(1000));
  CAPTURE(few);
  CAPTURE(many);
  CHECK(few > 0.0);
  CHECK(many < 1.6 * few);
}

// What a surface receives, however many lights there are to pick from: the mean is that of asking each.
TEST_CASE("picking lights by chance keeps the picture's mean") {
  Scene few = floor_under(4);
  const auto mean = [](const Image& image) {
    double sum = 0.0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += image.rgba[i];
    return sum;
  };
  const RenderSettings settings{
      .width = 16, .height = 16, .spp = 512, .seed = 2, .max_bounces = 0, .build = {}};
  const double expected = mean(render(few, settings));
  // The same light, from each lamp in four parts, at one place.
  Scene many = few;
  many.lights.clear();
  for (const Light& light : few.lights) {
    for (int part = 0; part < 4; ++part) {
      many.lights.push_back(light);
      many.lights.back().radiance = light.radiance * 0.25f;
    }
  }
  CHECK(mean(render(many, settings)) == doctest::Approx(expected).epsilon(2e-3));
}

}  // namespace
}  // namespace msbvh
