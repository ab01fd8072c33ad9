// Alpha of moving edges against the closed form of their coverage.
#include <numbers>

#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kWidth = 16, kRows = 128;
const RenderSettings kColumns{.width = kWidth, .height = kRows, .spp = 64, .max_bounces = 0, .build = {}};
// The edge of a quad that covers everything left of it, at the shutter's opening and closing.
constexpr float kOpen = 3.3f, kClose = 11.9f;

std::vector<Vec3f> left_of(float edge) { return rectangle(-100.0f, -10.0f, edge, kRows + 10.0f); }
double ramp(std::uint32_t x) { return swept(x, kOpen, kClose); }

TEST_CASE("a translating edge: the mesh moves") {
  Scene scene;
  scene.camera = pixel_camera(kWidth, kRows);
  add(scene, polygon({left_of(kOpen), left_of(kClose)}));
  check_columns(render(scene, kColumns), ramp);
}

TEST_CASE("a translating edge: an instance moves") {
  Scene scene;
  scene.camera = pixel_camera(kWidth, kRows);
  add_instance(scene, polygon({left_of(0.0f)}), {translation({kOpen, 0, 0}), translation({kClose, 0, 0})});
  check_columns(render(scene, kColumns), ramp);
}

TEST_CASE("a translating edge: the camera moves the other way") {
  Scene scene;
  scene.camera = pixel_camera(kWidth, kRows);
  scene.camera.segments = 1;
  scene.camera.world_from_camera = {translation({-kOpen, 0, 100}), translation({-kClose, 0, 100})};
  scene.camera.window.resize(2, scene.camera.window[0]);
  add(scene, polygon({left_of(0.0f)}));
  check_columns(render(scene, kColumns), ramp);
}

TEST_CASE("a translating edge: mesh and instance move, on tracks of different keys") {
  Scene scene;
  scene.camera = pixel_camera(kWidth, kRows);
  const float half = (kClose - kOpen) / 2;
  add_instance(scene, polygon({left_of(0.0f), left_of(half / 2), left_of(half)}),
               {translation({kOpen, 0, 0}), translation({kOpen + half, 0, 0})});
  check_columns(render(scene, kColumns), ramp);
}

TEST_CASE("a still edge: the pixel's share, top row first") {
  Scene scene;
  scene.camera = pixel_camera(kWidth, kRows);
  add(scene, polygon({rectangle(-1, kRows - 1.0f, 4.25f, kRows + 1.0f)}));  // the upper left corner
  const Image image = render(scene, kColumns);
  CHECK(channel(image, 0, 0, kAlpha) == 1.0f);
  CHECK(channel(image, 3, 0, kAlpha) == 1.0f);
  CHECK(channel(image, 4, 0, kAlpha) == 0.25f);  // 64 points are stratified in quarters, exactly
  CHECK(channel(image, 5, 0, kAlpha) == 0.0f);
  CHECK(channel(image, 0, 1, kAlpha) == 0.0f);
}

TEST_CASE("a quad that leaves the frame during the shutter") {
  constexpr float kLeft0 = 2.0f, kRight0 = 9.5f, kTravel = 30.0f;
  Scene scene;
  scene.camera = pixel_camera(kWidth, kRows);
  add(scene, polygon({rectangle(kLeft0, -10, kRight0, kRows + 10),
                      rectangle(kLeft0 + kTravel, -10, kRight0 + kTravel, kRows + 10)}));
  check_columns(render(scene, kColumns), [](std::uint32_t x) {
    return swept(x, kRight0, kRight0 + kTravel) - swept(x, kLeft0, kLeft0 + kTravel);
  });
}

// A quarter plane with its apex in the middle of the image, turning from kTheta0 to kTheta1. In each segment
// the matrix elements, hence the vertices, go along chords: the wedge stays a right angle and its angle is
// known.
constexpr double kTheta0 = 0.2, kTheta1 = 1.3;
constexpr std::uint32_t kSize = 16;

Affine3f turned(double angle) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {kSize / 2.0f, kSize / 2.0f, 0}};
}

std::vector<Affine3f> turning(std::uint32_t segments) {
  std::vector<Affine3f> keys;
  for (std::uint32_t i = 0; i <= segments; ++i) {
    keys.push_back(turned(kTheta0 + (kTheta1 - kTheta0) * i / segments));
  }
  return keys;
}

// The time at which the wedge's first edge reaches `angle`, clamped to the shutter.
double time_of_chord_angle(double angle, std::uint32_t segments) {
  const double step = (kTheta1 - kTheta0) / segments;
  const double place = (angle - kTheta0) / step;
  if (place <= 0) return 0;
  if (place >= segments) return 1;
  const double segment = std::floor(place), middle = kTheta0 + (segment + 0.5) * step;
  return (segment + 0.5 * (1 + std::tan(angle - middle) / std::tan(step / 2))) / segments;
}
double time_of_true_angle(double angle) {
  return std::clamp((angle - kTheta0) / (kTheta1 - kTheta0), 0.0, 1.0);
}

// Midpoint rule over the pixel; its error is below 2 / kGrid^2 except in the four pixels at the apex, where
// the integrand has no limit, and below 1 / kGrid there.
constexpr int kGrid = 100;
double wedge_coverage(std::uint32_t x, std::uint32_t y, const std::function<double(double)>& time_of_angle) {
  double sum = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const double px = x + (i % kGrid + 0.5) / kGrid - kSize / 2.0;
    const double py = kSize / 2.0 - (y + (i / kGrid + 0.5) / kGrid);
    const double angle = std::atan2(py, px);
    // Angles below -pi/2 are reached, if at all, by the second edge from the other side.
    const double up = angle < -std::numbers::pi / 2 ? angle + 2 * std::numbers::pi : angle;
    sum += time_of_angle(up) - time_of_angle(up - std::numbers::pi / 2);
  }
  return sum / (kGrid * kGrid);
}

// Where few samples hit, or few miss, their own variance says nothing: 5 deviations of the binomial
// distribution.
double rare_event_error(double coverage, std::uint32_t samples) {
  const double variance = coverage * (1 - coverage);
  return samples * variance < 25 ? 5 * std::sqrt(variance / samples) : 0.0;
}

void check_wedge(const Scene& scene, const std::function<double(double)>& time_of_angle, double error) {
  RenderSettings settings{.width = kSize, .height = kSize, .spp = 64, .max_bounces = 0, .build = {}};
  std::vector<Estimates> pixels(kSize * kSize);
  for (settings.seed = 0; settings.seed < 32; ++settings.seed) {
    const Image image = render(scene, settings);
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
      pixels[i].add(channel(image, i % kSize, i / kSize, kAlpha));
    }
  }
  for (std::uint32_t i = 0; i < pixels.size(); ++i) {
    const std::uint32_t x = i % kSize, y = i / kSize;
    CAPTURE(x);
    CAPTURE(y);
    const bool at_apex = (x == kSize / 2 || x + 1 == kSize / 2) && (y == kSize / 2 || y + 1 == kSize / 2);
    const double quadrature = at_apex ? 1.0 / kGrid : 2.0 / (kGrid * kGrid);
    const double coverage = wedge_coverage(x, y, time_of_angle);
    pixels[i].check(coverage, quadrature + error + rare_event_error(coverage, 32 * settings.spp));
  }
}

const std::vector<Vec3f> kWedge{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}};

TEST_CASE("a rotating edge: the motion between the keys is the chord's, on any number of segments") {
  for (const std::uint32_t segments : {1u, 2u, 16u}) {
    CAPTURE(segments);
    const auto time_of_angle = [&](double angle) { return time_of_chord_angle(angle, segments); };
    Scene scene;
    scene.camera = pixel_camera(kSize, kSize);
    SUBCASE("baked into the vertices") { add(scene, baked(polygon({kWedge}), turning(segments))); }
    SUBCASE("as an instance") { add_instance(scene, polygon({kWedge}), turning(segments)); }
    check_wedge(scene, time_of_angle, kSinglePrecision);
  }
}

TEST_CASE("a rotating edge: 64 segments follow the true rotation to within the chord's error") {
  constexpr std::uint32_t kSegments = 64;
  double chord_error = 0;  // in time
  for (double angle = kTheta0; angle < kTheta1; angle += 1e-4) {
    chord_error =
        std::max(chord_error, std::abs(time_of_chord_angle(angle, kSegments) - time_of_true_angle(angle)));
  }
  CHECK(chord_error < 1e-6);
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  add_instance(scene, polygon({kWedge}), turning(kSegments));
  check_wedge(scene, time_of_true_angle, chord_error + kSinglePrecision);
}

}  // namespace
}  // namespace msbvh
