// What cameras' optics and lights' inputs mean (delegate/translate/look).
#include <cmath>
#include <doctest/doctest.h>
#include <numbers>

#include "delegate/translate/look/light_radiance.h"
#include "delegate/translate/look/optics.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr Window kWide{-2.0, 2.0, -1.0, 1.0};

Optics full_frame() {
  Optics optics;
  optics.horizontal_aperture = 36.0;
  optics.vertical_aperture = 24.0;
  optics.focal_length = 50.0;
  return optics;
}

Matrix4d scaled(double x, double y, double z) {
  return {x, 0.0, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, 0.0, z, 0.0, 0.0, 0.0, 0.0, 1.0};
}

void check_window(const Window& found, double left, double right, double bottom, double top) {
  CHECK(found.left == doctest::Approx(left));
  CHECK(found.right == doctest::Approx(right));
  CHECK(found.bottom == doctest::Approx(bottom));
  CHECK(found.top == doctest::Approx(top));
}

}  // namespace

TEST_CASE("a perspective window is the aperture over the focal length, an orthographic one in stage units") {
  Optics optics = full_frame();
  check_window(window_of(optics), -0.36, 0.36, -0.24, 0.24);
  optics.horizontal_aperture_offset = 5.0;
  check_window(window_of(optics), -0.26, 0.46, -0.24, 0.24);
  optics.projection = Projection::kOrthographic;
  check_window(window_of(optics), -1.3, 2.3, -1.2, 1.2);
}

TEST_CASE("a window is fitted to a square image by each policy") {
  check_window(conformed(kWide, 1.0, AspectPolicy::kExpandAperture).window, -2.0, 2.0, -2.0, 2.0);
  check_window(conformed(kWide, 1.0, AspectPolicy::kCropAperture).window, -1.0, 1.0, -1.0, 1.0);
  check_window(conformed(kWide, 1.0, AspectPolicy::kAdjustApertureWidth).window, -1.0, 1.0, -1.0, 1.0);
  check_window(conformed(kWide, 1.0, AspectPolicy::kAdjustApertureHeight).window, -2.0, 2.0, -2.0, 2.0);
  const Conformed stretched = conformed(kWide, 1.0, AspectPolicy::kAdjustPixelAspectRatio);
  check_window(stretched.window, -2.0, 2.0, -1.0, 1.0);
  CHECK(stretched.pixel_aspect_ratio == doctest::Approx(2.0));
}

TEST_CASE("a window's centre stays where it is") {
  const Window shifted{1.0, 5.0, -1.0, 1.0};
  for (int policy = 0; policy < 4; ++policy) {
    for (const double aspect : {0.5, 3.0}) {
      const Window found = conformed(shifted, aspect, AspectPolicy(policy)).window;
      CHECK(found.left + found.right == doctest::Approx(6.0));
      CHECK(found.bottom + found.top == doctest::Approx(0.0));
      CHECK(found.width() / found.height() == doctest::Approx(aspect));
    }
  }
}

TEST_CASE("policies have USD's names") {
  for (std::size_t i = 0; i < aspect_policy_names().size(); ++i) {
    CHECK(aspect_policy(aspect_policy_names()[i]) == AspectPolicy(i));
  }
  CHECK(!aspect_policy("squeeze"));
}

TEST_CASE("an image's height is usdrecord's") {
  CHECK(image_height(960, 16.0 / 9.0) == 540);
  CHECK(image_height(1, 100.0) == 1);
  CHECK(image_height(100, 0.0) == 100);
  CHECK(image_height(100, NAN) == 100);
  CHECK(image_height(1 << 20, 1.1e-4) > 1LL << 32);
}

TEST_CASE("the f-number is the focal length over the diameter of the lens") {
  Optics optics = full_frame();
  CHECK(thin_lens(optics).radius == 0.0f);
  optics.f_stop = 2.0;
  CHECK(thin_lens(optics).radius == 0.0f);  // Nothing to focus at.
  optics.focus_distance = 8.0;
  CHECK(thin_lens(optics).radius == doctest::Approx(1.25));
  CHECK(thin_lens(optics).focus_distance == 8.0f);
}

TEST_CASE("emission is intensity, exposure, colour and temperature multiplied out") {
  const Vec3d found = light_emission(2.0, 3.0, {0.5, 1.0, 2.0}, {1.0, 0.5, 0.25});
  CHECK(found == Vec3d{8.0, 8.0, 8.0});
  CHECK(std::isinf(light_emission(1.0, 2000.0, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}).x));
}

TEST_CASE("normalisation divides by the light's area in the world") {
  const LightNumbers sizes{180.0, 2.0, 3.0, 4.0};
  CHECK(light_normalization(LightKind::kSphere, sizes, scaled(1, 1, 1)) == doctest::Approx(16.0 * kPi));
  CHECK(light_normalization(LightKind::kSphere, sizes, scaled(3, 3, 3)) == doctest::Approx(144.0 * kPi));
  CHECK(light_normalization(LightKind::kRect, sizes, scaled(2, 5, 7)) == doctest::Approx(120.0));
  CHECK(light_normalization(LightKind::kDistant, sizes, scaled(2, 5, 7)) ==
        doctest::Approx(kPi));  // a half sphere
  const LightNumbers tube{.radius = 2.0, .length = 3.0};
  CHECK(light_normalization(LightKind::kDisk, sizes, scaled(2, 5, 7)) == doctest::Approx(40.0 * kPi));
  CHECK(light_normalization(LightKind::kCylinder, tube, scaled(2, 3, 3)) == doctest::Approx(72.0 * kPi));
  CHECK(light_normalization(LightKind::kDome, sizes, scaled(2, 5, 7)) == 1.0);
  CHECK(light_normalization(LightKind::kRect, sizes, scaled(0, 1, 1)) == 1.0);
}

TEST_CASE("numbers that UsdLux clamps or ignores") {
  LightNumbers numbers;
  numbers.focus = -1.0;
  numbers.cone_angle_degrees = -5.0;
  numbers.cone_softness = 7.0;
  const LightValues values = light_values({1.0, 2.0, 3.0}, numbers);
  CHECK(values.radiance == Vec3f{1, 2, 3});
  CHECK(values.focus == 0.0f);
  CHECK(values.cone_angle_degrees == 0.0f);
  CHECK(values.cone_softness == 1.0f);
  numbers.cone_softness = -1.0;
  CHECK(light_values({}, numbers).cone_softness == 0.0f);
  numbers.diffuse = std::nan("");
  CHECK(std::isnan(light_values({}, numbers).diffuse));
}

TEST_CASE("a normalised sphere tends to its point") {
  const Vec3d one{1.0, 1.0, 1.0};
  const double radius = 1e-3;
  const LightNumbers small{0.0, radius, 0.0, 0.0}, point{0.0, 0.0, 0.0, 0.0};
  const double intensity =
      light_radiance(LightKind::kSphere, one, small, true, scaled(1, 1, 1)).x * kPi * radius * radius;
  CHECK(light_radiance(LightKind::kSphere, one, point, true, scaled(1, 1, 1)).x ==
        doctest::Approx(intensity));
  CHECK(light_radiance(LightKind::kRect, one, {0.0, 0.0, 2.0, 2.0}, false, scaled(1, 1, 1)).x == 1.0);
}
