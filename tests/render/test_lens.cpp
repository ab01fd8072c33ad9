// Depth of field against the thin lens's closed forms. A perspective camera at the origin, kScale pixels a
// unit of its window: a point at depth d is spread over a disc of radius kScale R |1/d - 1/f| pixels.
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 64;
constexpr double kScale = kSize / 2.0;
constexpr double kCenter = kSize / 2.0;
const RenderSettings kSettings{.width = kSize, .height = kSize, .spp = 1024, .max_bounces = 0, .build = {}};

Camera lens_camera(const std::vector<Lens>& keys) {
  Camera camera;
  camera.projection = Projection::kPerspective;
  camera.segments = static_cast<std::uint32_t>(keys.size()) - 1;
  camera.world_from_camera.resize(keys.size());
  camera.window.resize(keys.size());
  camera.lens = keys;
  camera.near_clip = 0.01f;
  return camera;
}

// A regular polygon about the axis at a depth. `radius` is that of its image, in pixels.
struct Disc {
  static constexpr int kSides = 24;
  double radius, depth;

  double area() const { return 0.5 * kSides * radius * radius * std::sin(2 * std::numbers::pi / kSides); }
  Mesh mesh() const {
    std::vector<Vec3f> corners;
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSides, r = radius * depth / kScale;
      corners.push_back({float(r * std::cos(angle)), float(r * std::sin(angle)), float(-depth)});
    }
    return polygon({corners});
  }
};

Image photograph(const Disc& disc, const std::vector<Lens>& keys) {
  Scene scene;
  scene.camera = lens_camera(keys);
  add(scene, disc.mesh());
  return render(scene, kSettings);
}

// Of the pixel's centre to the axis.
double distance(std::uint32_t x, std::uint32_t y) { return std::hypot(x + 0.5 - kCenter, y + 0.5 - kCenter); }

// The alpha of a small disc: its area over that of its circle of confusion inside, nothing outside.
void check_blur(const Image& image, const Disc& disc, double blur) {
  constexpr double kPixel = std::numbers::sqrt2 / 2;  // half a diagonal
  Estimates inside;
  double sum = 0, moment = 0;
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const double alpha = channel(image, x, y, kAlpha), r = distance(x, y);
      sum += alpha;
      moment += alpha * r * r;
      if (r < blur - disc.radius - kPixel) inside.add(alpha);
      if (r > blur + disc.radius + kPixel) CHECK(alpha == 0.0);
    }
  }
  inside.check(disc.area() / (std::numbers::pi * blur * blur), kSinglePrecision);
  const double sigma = 1.0 / std::sqrt(disc.area() * kSettings.spp);  // of the share of samples that hit
  CHECK(std::abs(sum / disc.area() - 1.0) <= 4.5 * sigma);            // what is spread is not lost
  // Second moment of a disc: half its radius squared; 1/6 for the pixels' own size.
  const double expected = (blur * blur + disc.radius * disc.radius) / 2 + 1.0 / 6;
  CHECK(std::abs(moment / sum / expected - 1.0) <= 4.5 * sigma / std::sqrt(3.0));
}

TEST_CASE("a small disc out of focus covers the thin lens's circle of confusion") {
  SUBCASE("behind the plane in focus") {
    const Disc disc{1.5, 4.0};
    check_blur(photograph(disc, {{1.0f, 2.0f}}), disc, kScale * 0.25);
  }
  SUBCASE("before it") {
    const Disc disc{1.5, 2.0};
    check_blur(photograph(disc, {{0.5f, 4.0f}}), disc, kScale * 0.125);
  }
  SUBCASE("a wide lens focused nearly at infinity") {
    const Disc disc{2.0, 10.0};
    check_blur(photograph(disc, {{6.0f, 1e6f}}), disc, kScale * 6.0 * (0.1 - 1e-6));
  }
}

TEST_CASE("a camera's scale scales its lens") {
  const Disc disc{1.5, 4.0};
  Scene scene;
  scene.camera = lens_camera({{0.5f, 1.0f}});
  scene.camera.world_from_camera = {Affine3f{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {}}};
  add(scene, disc.mesh());
  check_blur(render(scene, kSettings), disc, kScale * 0.25);
}

TEST_CASE("the plane in focus is as sharp as through a pinhole, at the picture's edge too") {
  Scene scene;
  scene.camera = lens_camera({{0.7f, 3.0f}});
  const float edge = float(3.0 * (50.5 - kCenter) / kScale);  // in the middle of pixel 50
  add(scene, polygon({rectangle(-9, -9, edge, 9, -3.0f)}));
  const Image image = render(scene, kSettings);
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      if (x != 50) CHECK(channel(image, x, y, kAlpha) == (x < 50 ? 1.0f : 0.0f));
    }
  }
}

TEST_CASE("a focus pull gives the average over its circles of confusion") {
  // Mean over t of area / (pi (s R (1/d - 1/f))^2), f = f0 + (f1 - f0) t.
  constexpr double kRadius = 2.0, kDepth = 8.0, f0 = 2.0, f1 = 4.0;
  const Disc disc{1.5, kDepth};
  const auto integral = [](double f) {
    return kDepth * kDepth * (f + 2 * kDepth * std::log(kDepth - f) - kDepth * kDepth / (f - kDepth));
  };
  const double mean = (integral(f1) - integral(f0)) / (f1 - f0) * disc.area() /
                      (std::numbers::pi * kScale * kScale * kRadius * kRadius);
  const double smallest = kScale * kRadius * (1 / f1 - 1 / kDepth);
  const Image image = photograph(disc, {{kRadius, f0}, {kRadius, f1}});
  Estimates inside;
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      if (distance(x, y) < smallest - disc.radius - 1) inside.add(channel(image, x, y, kAlpha));
    }
  }
  inside.check(mean, kSinglePrecision);
}

TEST_CASE("an iris that opens gives the average as well") {
  // Mean over t of area / (pi (s R b)^2), R = R0 + (R1 - R0) t: area / (pi s^2 b^2 R0 R1).
  const Disc disc{1.5, 4.0};
  const double blur0 = kScale * 0.6 * 0.25, blur1 = kScale * 1.8 * 0.25;
  const Image image = photograph(disc, {{0.6f, 2.0f}, {1.8f, 2.0f}});
  Estimates inside;
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      if (distance(x, y) < blur0 - disc.radius - 1) inside.add(channel(image, x, y, kAlpha));
    }
  }
  inside.check(disc.area() / (std::numbers::pi * blur0 * blur1), kSinglePrecision);
}

TEST_CASE("a closed lens is a pinhole, to the last bit") {
  const Disc disc{9.0, 4.0};
  const Image closed = photograph(disc, {{0.0f, 2.0f}, {0.0f, 5.0f}});
  Scene scene;
  scene.camera = lens_camera({{}});
  scene.camera.lens.clear();
  add(scene, disc.mesh());
  CHECK(render(scene, kSettings).rgba == closed.rgba);
}

TEST_CASE("clipping distances are depths from the lens's plane") {
  // Two cards whose edges are far from the axis: every ray meets both, the nearer one before the near plane.
  Scene scene;
  scene.camera = lens_camera({{1.0f, 2.0f}});
  scene.camera.near_clip = 3.0f;
  scene.camera.far_clip = 6.0f;
  for (const auto& [depth, seen] : {std::pair{2.99f, 0.0f}, {3.01f, 1.0f}, {5.99f, 1.0f}, {6.01f, 0.0f}}) {
    scene.meshes.clear();
    scene.world.clear();
    add(scene, polygon({rectangle(-90, -90, 90, 90, -depth)}));
    const Image image = render(scene, {.width = 8, .height = 8, .spp = 16, .max_bounces = 0, .build = {}});
    for (std::uint32_t i = 0; i < 64; ++i) CHECK(image.rgba[4 * i + kAlpha] == seen);
  }
}

}  // namespace
}  // namespace msbvh
