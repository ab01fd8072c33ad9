// AOVs of places and motion, against closed forms.
#include <algorithm>
#include <cmath>

#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

const AovImage& layer(const Image& image, Aov aov) {
  return *std::ranges::find(image.aovs, aov, &AovImage::aov);
}
float value(const Image& image, Aov aov, std::size_t pixel, std::size_t number = 0) {
  return layer(image, aov).values[pixel * form_of(aov).numbers + number];
}

RenderSettings asking(std::uint32_t width, std::uint32_t height, std::vector<Aov> aovs, FrameTime frame) {
  RenderSettings settings{.width = width, .height = height, .spp = 4, .max_bounces = 0, .build = {}};
  settings.aovs = std::move(aovs);
  settings.film.frame_time = frame;
  return settings;
}
const std::vector<Aov> kMotion{Aov::kForward, Aov::kBackward, Aov::kMotionCurve};
// Open for half a frame around it.
constexpr FrameTime kMiddle{0.5f, 0.5f};

void check_motion(const Image& image, std::size_t pixel, double fx, double fy, double bx, double by) {
  CHECK(value(image, Aov::kForward, pixel, 0) == doctest::Approx(fx).epsilon(1e-5).scale(1.0));
  CHECK(value(image, Aov::kForward, pixel, 1) == doctest::Approx(fy).epsilon(1e-5).scale(1.0));
  CHECK(value(image, Aov::kBackward, pixel, 0) == doctest::Approx(bx).epsilon(1e-5).scale(1.0));
  CHECK(value(image, Aov::kBackward, pixel, 1) == doctest::Approx(by).epsilon(1e-5).scale(1.0));
}

TEST_CASE("a quad that moves has its speed, forward to the next frame and back to the last") {
  Scene scene;
  scene.camera = pixel_camera(4, 4);
  // By 1 to the right and 0.5 down in half a frame: 2 and -1 pixels a frame, y up.
  add(scene, polygon({rectangle(-9, -9, 9, 9), rectangle(-8, -9.5f, 10, 8.5f)}));
  const Image image = render(scene, asking(4, 4, kMotion, kMiddle));
  for (std::size_t pixel = 0; pixel < 16; ++pixel) check_motion(image, pixel, 2.0, -1.0, -2.0, 1.0);
}

TEST_CASE("a quad that turns back at the frame has two speeds") {
  Scene scene;
  scene.camera = pixel_camera(2, 2);
  add(scene, polygon({rectangle(-9, -9, 9, 9), rectangle(-8, -9, 10, 9), rectangle(-11, -9, 7, 9)}));
  // Two segments over half a frame: 4 pixels a frame to the right before, 12 to the left after it.
  const Image image = render(scene, asking(2, 2, kMotion, kMiddle));
  check_motion(image, 0, -12.0, 0.0, -4.0, 0.0);
  // With the frame where the shutter opens there is nothing before it.
  check_motion(render(scene, asking(2, 2, kMotion, {0.0f, 0.5f})), 0, 4.0, 0.0, -4.0, 0.0);
}

TEST_CASE("still things have no motion, nor has anything with a closed shutter") {
  Scene scene;
  scene.camera = pixel_camera(2, 1);
  add(scene, polygon({rectangle(0, 0, 1, 1)}));
  const Image image = render(scene, asking(2, 1, kMotion, kMiddle));
  for (std::size_t pixel = 0; pixel < 2; ++pixel) {
    check_motion(image, pixel, 0, 0, 0, 0);
    for (std::size_t i = 0; i < 8; ++i) CHECK(value(image, Aov::kMotionCurve, pixel, i) == 0.0f);
  }
  Scene moving;
  moving.camera = pixel_camera(1, 1);
  add(moving, polygon({rectangle(-9, -9, 9, 9), rectangle(-8, -9, 10, 9)}));
  check_motion(render(moving, asking(1, 1, kMotion, {0.0f, 0.0f})), 0, 0, 0, 0, 0);
}

// Looks down at z = 0 from 10 above it; its window is 2 wide at unit distance.
Camera perspective_camera() {
  Camera camera;
  camera.world_from_camera = {translation({0, 0, 10})};
  camera.window = {{-1, 1, -1, 1}};
  camera.near_clip = 0.1f;
  return camera;
}

TEST_CASE("a camera that moves, zooms and dollies moves what stands still") {
  Scene scene;
  scene.camera = perspective_camera();
  add(scene, polygon({rectangle(-99, -99, 99, 99)}));
  const auto at_centre = [&] { return render(scene, asking(64, 64, kMotion, kMiddle)); };
  const std::size_t pixel = 64 * 32 + 48;  // right of the centre
  SUBCASE("sideways") {
    scene.camera.segments = 1;
    scene.camera.world_from_camera = {translation({0, 0, 10}), translation({1, 0, 10})};
    scene.camera.window.push_back(scene.camera.window[0]);
    // 2 units a frame at distance 10, where 20 units are 64 pixels: the picture runs to the left.
    check_motion(at_centre(), pixel, -6.4, 0.0, 6.4, 0.0);
  }
  SUBCASE("forward") {
    scene.camera.segments = 1;
    scene.camera.world_from_camera = {translation({0, 0, 11}), translation({0, 0, 9})};
    scene.camera.window.push_back(scene.camera.window[0]);
    const Image image = render(scene, asking(64, 64, {Aov::kForward, Aov::kBackward, Aov::kPworld}, kMiddle));
    // A point X to the right is seen at 32 X / d pixels from the centre; at the frame d = 10, and it falls by
    // 4 a frame.
    const double x = value(image, Aov::kPworld, pixel, 0), y = value(image, Aov::kPworld, pixel, 1);
    CHECK(x > 4.0);
    check_motion(image, pixel, 3.2 * x * 0.4, 3.2 * y * 0.4, -3.2 * x * 0.4, -3.2 * y * 0.4);
  }
  SUBCASE("its window") {
    scene.camera.segments = 1;
    scene.camera.world_from_camera.push_back(scene.camera.world_from_camera[0]);
    scene.camera.window.push_back({-2, 0, -1, 1});
    // The window runs to the left by 2 units of the plane at distance 1 a frame: the picture to the right.
    check_motion(at_centre(), pixel, 64.0, 0.0, -64.0, 0.0);
  }
}

TEST_CASE("motion is that of the point hit, whatever has moved it there") {
  // An instance that turns about the origin by its matrix elements, seen from above, all hits at the frame.
  Scene scene;
  scene.camera = pixel_camera(4, 4);
  scene.camera.window = {{-2, 2, -2, 2}};
  const Affine3f from{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}}, to{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {}};
  add_instance(scene, polygon({rectangle(-9, -9, 9, 9)}), {from, to});
  RenderSettings settings = asking(4, 4, {Aov::kForward, Aov::kPworld}, {0.5f, 1.0f});
  settings.spp = 1;
  const Image image = render(scene, settings);
  // d/dt of M(t) p is (M1 - M0) p: of the point p that lies at q at the sample's time. Its rate does not
  // depend on the time, but p does: M(t) = [1 - t, -t; t, 1 - t], p = M(t)^-1 q.
  for (std::size_t pixel = 0; pixel < 16; ++pixel) {
    const double fx = value(image, Aov::kForward, pixel, 0), fy = value(image, Aov::kForward, pixel, 1);
    const double qx = value(image, Aov::kPworld, pixel, 0), qy = value(image, Aov::kPworld, pixel, 1);
    // (fx, fy) = (M1 - M0) p = (-px - py, px - py), so that |f|^2 = 2 |p|^2, and M(t)^T M(t) = (1 - 2 t (1 -
    // t)) I.
    const double p2 = (fx * fx + fy * fy) / 2.0, q2 = qx * qx + qy * qy;
    CHECK(q2 / p2 >= 0.5 - 1e-5);
    CHECK(q2 / p2 <= 1.0 + 1e-5);
    const double px = (fy - fx) / 2.0, py = -(fx + fy) / 2.0, shrunk = q2 / p2;
    const double t = 0.5 - std::sqrt(std::max(0.0, 2.0 * shrunk - 1.0)) / 2.0;
    const auto lies_at = [&](double s) {
      return std::hypot((1 - s) * px - s * py - qx, s * px + (1 - s) * py - qy);
    };
    CHECK(std::min(lies_at(t), lies_at(1.0 - t)) < 1e-4);
  }
}

TEST_CASE("the way over the picture of a cubic is itself") {
  Scene scene;
  scene.camera = pixel_camera(1, 1);
  const double x[] = {0, 3, -1, 2}, y[] = {0, 1, 1, -1};
  Mesh quad = polygon({rectangle(-50, -50, 50, 50)});
  const std::vector<Vec3f> still(quad.shape.positions.begin(), quad.shape.positions.begin() + 4);
  quad.shape.segments = 1;
  quad.shape.degree = 3;
  quad.shape.positions.clear();
  for (int i = 0; i < 4; ++i) {
    for (const Vec3f& p : still) quad.shape.positions.push_back(p + Vec3f{float(x[i]), float(y[i]), 0.0f});
  }
  add(scene, quad);
  const Image image = render(scene, asking(1, 1, kMotion, {0.25f, 2.0f}));
  const auto at = [](const double(&c)[4], double w) {
    const double v = 1 - w;
    return v * v * v * c[0] + 3 * v * v * w * c[1] + 3 * v * w * w * c[2] + w * w * w * c[3];
  };
  const auto rate = [](const double(&c)[4], double w) {
    const double v = 1 - w;
    return 3 * (v * v * (c[1] - c[0]) + 2 * v * w * (c[2] - c[1]) + w * w * (c[3] - c[2]));
  };
  check_motion(image, 0, rate(x, 0.25) / 2, rate(y, 0.25) / 2, -rate(x, 0.25) / 2, -rate(y, 0.25) / 2);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(value(image, Aov::kMotionCurve, 0, 2 * i) == doctest::Approx(x[i] - at(x, 0.25)).epsilon(1e-4));
    CHECK(value(image, Aov::kMotionCurve, 0, 2 * i + 1) == doctest::Approx(y[i] - at(y, 0.25)).epsilon(1e-4));
  }
}

TEST_CASE("breakpoints at odd times have the speeds on their two sides") {
  // An instance that stands until a third of the shutter and then runs: a remap with one key at the frame.
  Scene scene;
  scene.camera = pixel_camera(1, 1);
  add_instance(scene, polygon({rectangle(-9, -9, 9, 9)}),
               {translation({0, 0, 0}), translation({0, 0, 0}), translation({1, 0, 0})});
  const float third = 1.0f / 3.0f;
  scene.instances[0].time_remap.pieces = {{0.0f, 0.0f, 0.5f, true}, {third, 0.5f, 1.0f, true}};
  // After it: 1 pixel in two thirds of the shutter of one frame.
  check_motion(render(scene, asking(1, 1, kMotion, {third, 1.0f})), 0, 1.5, 0.0, 0.0, 0.0);
}

TEST_CASE("curves and points move with their centres") {
  Scene scene;
  scene.camera = pixel_camera(2, 1);
  Points points;
  points.shape.name = "/points";
  points.shape.segments = 1;
  points.shape.point_count = 1;
  points.shape.vertices = {{{0.5f, 0.5f, 0}, 5.0f}, {{1.5f, 0.0f, 0}, 5.0f}};
  scene.points.push_back(points);
  scene.world.push_back({GeometryKind::kPoints, 0});
  check_motion(render(scene, asking(2, 1, kMotion, kMiddle)), 0, 2.0, -1.0, -2.0, 1.0);
}

TEST_CASE("places are those of the nearest sample, from the stage's origin and from the camera") {
  Scene scene;
  scene.camera = perspective_camera();
  add(scene, polygon({rectangle(-99, -99, 1, 99)}));
  RenderSettings settings = asking(2, 2, {Aov::kPworld, Aov::kPeye, Aov::kCameraDepth}, kMiddle);
  settings.film.origin = {1000.0, 0.0, -3.0};
  settings.film.filter.width = 0.001f;
  const Image image = render(scene, settings);
  // The centre of the left pixel above: 5 units from the middle each way.
  const double world[] = {995, 5, -3}, eye[] = {-5, 5, -10};
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(value(image, Aov::kPworld, 0, c) == doctest::Approx(world[c]).epsilon(1e-3));
    CHECK(value(image, Aov::kPeye, 0, c) == doctest::Approx(eye[c]).epsilon(1e-3));
    CHECK(value(image, Aov::kPworld, 1, c) == 0.0f);  // the right one sees nothing
  }
}

TEST_CASE("st is the primvar of that name, an instance's own before its geometry's") {
  Scene scene;
  scene.camera = pixel_camera(4, 1);
  scene.primvar_names = {"other", "st"};
  Mesh mesh = polygon({rectangle(0, 0, 2, 1)});
  SurfacePrimvar st{.name = 1, .primvar = {Interpolation::kVertex, 0, {}}};
  st.primvar.values = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.primvars = {st};
  add(scene, mesh);
  add_instance(scene, mesh, {translation({2, 0, 0})});
  scene.instances[0].primvars = {{.name = 1, .values = {{0.25f, 0.75f, 0}}}};
  RenderSettings settings = asking(4, 1, {Aov::kSt}, kMiddle);
  settings.film.filter.width = 0.001f;
  const Image image = render(scene, settings);
  CHECK(value(image, Aov::kSt, 0, 0) == doctest::Approx(0.25).epsilon(1e-2));
  CHECK(value(image, Aov::kSt, 0, 1) == doctest::Approx(0.5).epsilon(1e-2));
  CHECK(value(image, Aov::kSt, 1, 0) == doctest::Approx(0.75).epsilon(1e-2));
  CHECK(value(image, Aov::kSt, 2, 0) == 0.25f);
  CHECK(value(image, Aov::kSt, 3, 1) == 0.75f);
  scene.primvar_names = {"other", "uv"};
  CHECK(value(render(scene, settings), Aov::kSt, 1, 0) == 0.0f);
}

}  // namespace
}  // namespace msbvh
