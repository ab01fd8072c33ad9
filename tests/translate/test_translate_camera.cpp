// The camera's track and its checks.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

#include "core/base/error.h"
#include "core/motion/affine_track.h"
#include "core/scene/scene.h"
#include "core/shade/camera.h"
#include "delegate/translate/translator.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::translate::testing;

namespace {

CameraInput moving_camera(const Motion& motion, const std::vector<double>& times01) {
  CameraInput camera = camera_at({});
  camera.samples.clear();
  for (const double time01 : times01)
    camera.samples.push_back({time01, row_vector_matrix(motion(time01)), {}});
  return camera;
}

Camera fitted(const CameraInput& input) { return Translator(input, linear_settings()).finish()->camera; }

// One line that names the camera and `found`.
void check_throws(const CameraInput& camera, const TranslatorSettings& settings, const std::string& found) {
  try {
    Translator translator(camera, settings);
    FAIL("accepted");
  } catch (const Error& error) {
    const std::string what = error.what();
    INFO(what);
    CHECK(what.find(found) != std::string::npos);
    CHECK(what.find("expected") != std::string::npos);
    CHECK(what.find('\n') == std::string::npos);
  }
}

}  // namespace

TEST_SUITE("translate: camera") {
  TEST_CASE("a clipping range that changes is followed on the camera's own track") {
    CameraInput camera = camera_at({0, 0, 10});
    const CameraSample still = camera.samples[0];
    camera.samples.clear();
    camera.breakpoints01 = {0.0, 0.375, 1.0};
    for (const auto& [time01, clip] :
         std::vector<std::pair<double, ClipRange>>{{0.0, {1, 100}}, {0.375, {4, 50}}, {1.0, {2, 1000}}}) {
      camera.samples.push_back(still);
      camera.samples.back().time01 = time01;
      camera.samples.back().clip = clip;
    }
    const Camera fit = fitted(camera);
    CHECK(fit.segments > 0);
    for (const double time01 : {0.0, 0.2, 0.375, 0.6, 1.0}) {
      const Ray ray = camera_ray(fit, 0.5f, 0.5f, float(time01));
      const bool first = time01 < 0.375;
      const double w = first ? time01 / 0.375 : (time01 - 0.375) / 0.625;
      CHECK(ray.tnear == doctest::Approx(first ? 1 + 3 * w : 4 - 2 * w).epsilon(1e-4));
      CHECK(ray.tfar == doctest::Approx(first ? 100 - 50 * w : 50 + 950 * w).epsilon(1e-4));
    }
    CHECK(fit.world_from_camera.front() == fit.world_from_camera.back());
  }

  TEST_CASE("a camera that stands still has one key at the frame's origin, however often it is sampled") {
    const Camera camera = fitted(moving_camera(
        [](double) {
          return translation({5, 6, 1e7});
        },
        uniform_times(16)));
    CHECK(camera.segments == 0);
    CHECK(camera.world_from_camera.at(0) == Affine3f{});
  }

  TEST_CASE("the origin is the camera at the shutter's centre") {
    const Camera camera = fitted(moving_camera(
        [](double u) {
          return translation({1e7 + 2 * u, 0, 0});
        },
        {0.0, 1.0}));
    CHECK(camera.segments == 1);
    CHECK(camera.world_from_camera.at(0).t == Vec3f{-1, 0, 0});
    CHECK(camera.world_from_camera.at(1).t == Vec3f{1, 0, 0});
  }

  TEST_CASE("a rolling camera is followed within a tenth of the tolerance") {
    const auto roll = [](double u) { return rotation(20 * u); };
    const Camera camera = fitted(moving_camera(roll, uniform_times(128)));
    CHECK(camera.segments >= 4);
    CHECK(camera.segments <= 64);
    double worst = 0.0;
    for (int i = 0; i <= 128; ++i) {  // the front-end's own samples
      const double u = i / 128.0;
      const Affine3d found(evaluate(camera.world_from_camera, camera.segments, float(u)));
      // The image's corner, at infinity.
      const Vec3d seen = inverse(found).vector(roll(u).vector({1, 1, -1}));
      worst = std::max(worst, 500 * length(seen * (-1 / seen.z) - Vec3d{1, 1, -1}));
    }
    CHECK(worst <= 0.01 + 1e-4);  // single-precision matrices: 500 pixels * 2^-23
  }

  TEST_CASE("a zoom moves the window alone") {
    CameraInput input = camera_at({});
    input.samples.push_back(input.samples[0]);
    input.samples[1].time01 = 1.0;
    input.samples[1].window = {-2, 2, -2, 2};
    const Camera camera = fitted(input);
    CHECK(camera.segments == 1);
    CHECK(camera.window.at(1).left == -2.0f);
  }

  // Largest difference, in pixels of 1000, of the blur radius R (1/d - 1/f) at depths from near to infinity,
  // zoom included.
  double lens_deviation(const Camera& camera, const std::function<CameraSample(double)>& truth) {
    double worst = 0.0;
    for (int i = 0; i <= 1024; ++i) {
      const double u = i / 1024.0;
      const SegmentTime at = locate(float(u), camera.segments);
      const std::size_t next = std::min<std::size_t>(at.key + 1, camera.segments);
      const auto mix = [&](double a, double b) { return (1 - at.w) * a + at.w * b; };
      const Lens &a = camera.lens[at.key], &b = camera.lens[next];
      const double radius = mix(a.radius, b.radius), focus = mix(a.focus_distance, b.focus_distance);
      const double size = 2 * mix(camera.window[at.key].right, camera.window[next].right);
      const CameraSample expected = truth(u);
      for (const double inverse_depth : {10.0, 1.0, 0.1, 0.0}) {
        const double found = 1000 / size * radius * (inverse_depth - 1 / focus);
        const double wanted = 1000 / (2 * expected.window.right) * expected.lens.radius *
                              (inverse_depth - 1 / expected.lens.focus_distance);
        worst = std::max(worst, std::abs(found - wanted));
      }
    }
    return worst;
  }

  TEST_CASE("focus pulls and zooms through a lens are followed within a tenth of the tolerance") {
    std::function<CameraSample(double)> truth;
    SUBCASE("focus and iris, linear: one segment") {
      truth = [](double u) {
        return CameraSample{u, row_vector_matrix({}), {}, {float(0.01 + 0.01 * u), float(2 + 3 * u)}};
      };
      CameraInput input = camera_at({});
      input.samples = {truth(0.0), truth(1.0)};
      CHECK(fitted(input).segments == 1);
    }
    SUBCASE("an eased pull") {
      truth = [](double u) {
        return CameraSample{u, row_vector_matrix({}), {}, {0.02f, float(3 + 2 * std::cos(3 * u))}};
      };
    }
    SUBCASE("a zoom at constant f-number") {
      truth = [](double u) {
        const float focal = float(1 + u), w = 1 / focal;
        return CameraSample{u, row_vector_matrix({}), {-w, w, -w, w}, {0.02f * focal, 4.0f}};
      };
    }
    CameraInput input = camera_at({});
    input.samples.clear();
    for (const double u : uniform_times(128)) input.samples.push_back(truth(u));
    const Camera camera = fitted(input);
    CHECK(camera.segments >= 1);
    CHECK(camera.segments <= 128);
    // 0.01 of the fit, and what straight lines between the 129 samples and single precision leave out.
    CHECK(lens_deviation(camera, truth) <= 0.01 + 0.005);
  }

  TEST_CASE("a pinhole has no lens keys") { CHECK(fitted(camera_at({})).lens.empty()); }

  TEST_CASE("cameras and settings that cannot be used throw one line") {
    CameraInput camera = camera_at({});
    TranslatorSettings settings = settings_of();
    SUBCASE("no samples") {
      camera.samples.clear();
      check_throws(camera, settings, "/camera.shutter: no samples");
    }
    SUBCASE("singular") {
      camera.samples[0].world_from_camera[0] = 0.0;
      check_throws(camera, settings, "/camera.xformOpOrder");
    }
    SUBCASE("NaN") {
      camera.samples[0].world_from_camera[13] = std::numeric_limits<double>::quiet_NaN();
      check_throws(camera, settings, "/camera.xformOpOrder");
    }
    SUBCASE("no aperture") {
      camera.samples[0].window.right = -1.0f;
      check_throws(camera, settings, "/camera.horizontalAperture");
    }
    SUBCASE("near behind far") {
      camera.near_clip = 10;
      camera.far_clip = 1;
      check_throws(camera, settings, "/camera.clippingRange: found 10 to 1");
    }
    SUBCASE("near behind far in one sample") {
      camera.samples[0].clip = ClipRange{5, 2};
      check_throws(camera, settings, "/camera.clippingRange: found 5 to 2 at shutter time 0");
    }
    SUBCASE("a clipping range in some samples") {
      camera.samples.push_back(camera.samples[0]);
      camera.samples[1].time01 = 1.0;
      camera.samples[1].clip = ClipRange{1, 2};
      check_throws(camera, settings, "/camera.clippingRange: found in some samples only");
    }
    SUBCASE("a perspective camera that sees its own eye") {
      camera.near_clip = 0;
      check_throws(camera, settings, "/camera.clippingRange");
    }
    SUBCASE("an aperture that is no number") {
      camera.samples[0].lens.radius = std::numeric_limits<float>::infinity();
      check_throws(camera, settings, "/camera.fStop: the lens radius at shutter time 0");
    }
    SUBCASE("focus at the eye") {
      camera.samples[0].lens = {0.1f, 0.0f};
      check_throws(camera, settings, "/camera.focusDistance: found 0");
    }
    SUBCASE("parallel rays through a lens") {
      camera.projection = Projection::kOrthographic;
      camera.samples[0].lens.radius = 0.1f;
      check_throws(camera, settings, "/camera.fStop: an orthographic camera");
    }
    SUBCASE("no pixels") {
      settings.width = 0;
      check_throws(camera, settings, "image size: found 0 x");
    }
    SUBCASE("no tolerance") {
      settings.motion_tolerance_pixels = std::numeric_limits<double>::quiet_NaN();
      check_throws(camera, settings, "motion tolerance");
    }
    SUBCASE("segments that are no power of two") {
      settings.max_segments = 100;
      check_throws(camera, settings, "max_segments: found 100");
    }
  }
}
