// delegate/translate/frame: shutters, intervals, cameras and primvars as front-ends look them up.
#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "delegate/translate/frame/camera_moments.h"
#include "delegate/translate/frame/clipping_planes.h"
#include "delegate/translate/frame/intervals.h"
#include "delegate/translate/frame/motion_scale.h"
#include "delegate/translate/frame/primvar_policy.h"
#include "delegate/translate/frame/shutter.h"
#include "delegate/translate/sample/even_times.h"
#include "tests/translate/translate_inputs.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Optics lens_of_50_mm() {
  Optics optics;
  optics.horizontal_aperture = 20.0;
  optics.vertical_aperture = 10.0;
  optics.focal_length = 50.0;
  return optics;
}

CameraMoment moment(double time01, const Optics& optics, const Vec3d& eye = {}) {
  return {time01, testing::row_vector_matrix(testing::translation(eye)), optics, {0.1f, 100.0f}};
}

std::string error_of(const std::string& path, const Optics& optics, const ClipRange& clip) {
  try {
    check_optics(path, optics, clip);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a shutter that makes no sense is closed, and says what was found") {
  std::vector<Diagnostic> said;
  const ShutterSource camera{"/cam"};
  CHECK(checked_shutter(-0.25, 0.25, camera, said) == Shutter{-0.25, 0.25});
  CHECK(said.empty());
  CHECK_FALSE(checked_shutter(0.25, -0.25, camera, said).moving());
  REQUIRE(said.size() == 1);
  CHECK(said[0].severity == Severity::kWarning);
  CHECK(said[0].path == "/cam");
  CHECK(said[0].message == "found -0.25, before shutter:open at 0.25, expected a later time; no motion blur");
  CHECK_FALSE(checked_shutter(kInfinity, 1.0, camera, said).moving());
  CHECK_FALSE(
      checked_shutter(-std::numeric_limits<double>::max(), std::numeric_limits<double>::max(), camera, said)
          .moving());
  CHECK(said.size() == 3);
  CHECK_FALSE(checked_shutter(0.0, 0.0, camera, said).moving());
  CHECK(said.back().severity == Severity::kNote);
  CHECK(checked_shutter(0.0, 100.0, camera, said).moving());
  CHECK(said.back().severity == Severity::kWarning);
}

TEST_CASE("times run from the shutter's opening to its closing, about the frame") {
  const Shutter shutter{-0.25, 0.75};
  CHECK(shutter.time01(-0.25) == 0.0);
  CHECK(shutter.time01(0.75) == 1.0);
  CHECK(shutter.frame01() == 0.25);
  CHECK(shutter.frames_at(0.5) == 0.25);
  CHECK(shutter.scaled(2.0) == Shutter{-0.5, 1.5});
  CHECK(Shutter{0.5, 1.0}.frame01() == -1.0);
  CHECK(Shutter{0.5, 1.0}.clamped_frame01() == 0.0);
  CHECK(Shutter{}.time01(3.0) == 0.0);
  const RateTimes rates = rate_times(shutter, 24.0, 2.0);
  CHECK(rates.frame01 == 0.25);
  CHECK(rates.seconds_per_shutter == doctest::Approx(1.0 / 24.0));
  CHECK(rates.velocity_scale == 2.0f);
  CHECK(rate_times(Shutter{}, 24.0).seconds_per_shutter == 0.0);
}

TEST_CASE("visibility is held from one time to the next") {
  const double begins[] = {0.0, 0.25, 0.5};
  const bool always[] = {true, true, true}, blinks[] = {true, false, true}, twice[] = {false, true, true};
  CHECK_FALSE(visible_intervals(begins, always));
  const Visibility found = visible_intervals(begins, blinks);
  REQUIRE(found);
  REQUIRE(found->size() == 2);
  CHECK((*found)[0].end01 == 0.25);
  CHECK((*found)[1].begin01 == 0.5);
  CHECK((*found)[1].end01 > 1.0);
  const Visibility joined = visible_intervals(begins, twice);
  REQUIRE(joined);
  REQUIRE(joined->size() == 1);
  CHECK(joined->front().begin01 == 0.25);

  CHECK_FALSE(common_intervals({}, {}));
  CHECK(common_intervals({}, found)->size() == 2);
  const Visibility both = common_intervals(found, joined);
  REQUIRE(both);
  REQUIRE(both->size() == 1);
  CHECK(both->front().begin01 == 0.5);
  CHECK(common_intervals(Visibility{{{0.0, 0.5}}}, Visibility{{{0.5, 1.0}}})->empty());
}

TEST_CASE("optics that make no image are named") {
  const ClipRange clip{1.0f, 10.0f};
  Optics optics = lens_of_50_mm();
  CHECK(error_of("/cam", optics, clip).empty());
  optics.focal_length = 0.0;
  CHECK(error_of("/cam", optics, clip) == "/cam.focalLength: found 0, expected a finite number above 0");
  optics.projection = Projection::kOrthographic;
  CHECK(error_of("/cam", optics, clip).empty());
  optics.vertical_aperture = std::nan("");
  CHECK(error_of("/cam", optics, clip).starts_with("/cam.verticalAperture: found nan"));
  optics = lens_of_50_mm();
  optics.horizontal_aperture_offset = 1e9;
  CHECK(error_of("/cam", optics, clip).starts_with("/cam.horizontalApertureOffset: found 1e+09"));
  CHECK(error_of("/cam", lens_of_50_mm(), {2.0f, 1.0f}) ==
        "/cam.clippingRange: found (2, 1), expected near < far");
}

TEST_CASE("a lens is one for all of the shutter, or that of the frame") {
  std::vector<Diagnostic> said;
  Optics open = lens_of_50_mm(), closed = lens_of_50_mm();
  open.f_stop = 2.0;
  open.focus_distance = 10.0;
  const Optics steady[] = {open, open}, mixed[] = {open, closed};
  CHECK(lenses_of("/cam", open, steady, said)[1].radius == doctest::Approx(1.25f));
  CHECK(said.empty());
  const std::vector<Lens> taken = lenses_of("/cam", open, mixed, said);
  CHECK(taken[1].radius == doctest::Approx(1.25f));
  CHECK(said.size() == 1);
  const Optics pinholes[] = {closed};
  CHECK(lenses_of("/cam", closed, pinholes, said)[0].radius == 0.0f);
  CHECK(said.size() == 1);
  open.f_stop = -1.0;
  CHECK(lenses_of("/cam", open, pinholes, said)[0].radius == 0.0f);
  CHECK(said.back().attribute == "fStop");
}

TEST_CASE("a camera shows the part of its window that the image has pixels of") {
  std::vector<Diagnostic> said;
  const CameraMoment still = moment(0.0, lens_of_50_mm());
  Framing framing;
  framing.image_aspect = 2.0;
  const CameraInput whole = camera_input("/cam", still, std::span(&still, 1), {}, framing, said);
  CHECK(whole.samples[0].window.left == doctest::Approx(-0.2f));
  CHECK(whole.samples[0].window.top == doctest::Approx(0.1f));
  framing.part = {0.5, 1.0, 0.0, 0.5};  // the quarter at the lower right
  const CameraInput quarter = camera_input("/cam", still, std::span(&still, 1), {}, framing, said);
  CHECK(quarter.samples[0].window.left == doctest::Approx(0.0f));
  CHECK(quarter.samples[0].window.right == doctest::Approx(0.2f));
  CHECK(quarter.samples[0].window.bottom == doctest::Approx(-0.1f));
  CHECK(quarter.samples[0].window.top == doctest::Approx(0.0f));
  CHECK(pixel_size_of(whole, 200, 100).per_unit() == doctest::Approx(0.002));
}

TEST_CASE("a camera that stays the same has one sample, one that zooms all of them") {
  std::vector<Diagnostic> said;
  Optics tele = lens_of_50_mm();
  tele.focal_length = 100.0;
  const CameraMoment same[] = {moment(0.0, tele), moment(1.0, tele)};
  const CameraMoment zooms[] = {moment(0.0, lens_of_50_mm()), moment(1.0, tele)};
  CHECK(camera_input("/cam", same[0], same, {}, {}, said).samples.size() == 1);
  CHECK(camera_input("/cam", same[0], zooms, {}, {}, said).samples.size() == 2);
  CameraMoment near[] = {moment(0.0, tele), moment(1.0, tele)};
  near[1].clip.near_clip = 0.05f;
  const CameraInput clipped = camera_input("/cam", near[0], near, {}, {}, said);
  REQUIRE(clipped.samples.size() == 2);
  CHECK(clipped.near_clip == 0.05f);
  CHECK(clipped.samples[0].clip->near_clip == 0.1f);
}

TEST_CASE("a projection matrix says its window and its clipping range") {
  const double l = -0.4, r = 0.6, b = -0.1, t = 0.3, n = 2.0, f = 50.0;  // at the near plane
  const Matrix4d perspective{2 * n / (r - l),
                             0,
                             0,
                             0,
                             0,
                             2 * n / (t - b),
                             0,
                             0,
                             (r + l) / (r - l),
                             (t + b) / (t - b),
                             -(f + n) / (f - n),
                             -1,
                             0,
                             0,
                             -2 * f * n / (f - n),
                             0};
  const auto seen = projected_by(perspective);
  REQUIRE(seen);
  CHECK(seen->projection == Projection::kPerspective);
  CHECK(seen->window.left == doctest::Approx(l / n));
  CHECK(seen->window.right == doctest::Approx(r / n));
  CHECK(seen->window.bottom == doctest::Approx(b / n));
  CHECK(seen->window.top == doctest::Approx(t / n));
  CHECK(seen->clip.near_clip == doctest::Approx(n));
  CHECK(seen->clip.far_clip == doctest::Approx(f));
  const Matrix4d orthographic{2 / (r - l),
                              0,
                              0,
                              0,
                              0,
                              2 / (t - b),
                              0,
                              0,
                              0,
                              0,
                              -2 / (f - n),
                              0,
                              -(r + l) / (r - l),
                              -(t + b) / (t - b),
                              -(f + n) / (f - n),
                              1};
  const auto flat = projected_by(orthographic);
  REQUIRE(flat);
  CHECK(flat->projection == Projection::kOrthographic);
  CHECK(flat->window.right == doctest::Approx(r));
  CHECK(flat->window.bottom == doctest::Approx(b));
  CHECK(flat->clip.near_clip == doctest::Approx(n));
  CHECK(flat->clip.far_clip == doctest::Approx(f));
  CHECK_FALSE(projected_by(Matrix4d{}));
}

TEST_CASE("samples of a primvar that cannot be interpolated give way to the frame's") {
  const std::vector<float> frame{1.0f, 2.0f}, later{1.0f, 3.0f}, shorter{1.0f},
      broken{1.0f, std::numeric_limits<float>::quiet_NaN()};
  std::vector<Diagnostic> said;
  PrimLog log(said, "/mesh");
  const auto settled = [&](const std::vector<float>& at_frame, std::vector<PrimvarSample<float>> samples) {
    PrimvarInput<float> primvar;
    primvar.values = at_frame;
    primvar.samples = std::move(samples);
    settle_samples(primvar, "primvars:displayOpacity", log);
    return primvar.samples.size();
  };
  CHECK(settled(frame, {{0.0, frame}, {1.0, later}}) == 2);
  CHECK(settled(frame, {{0.0, frame}, {1.0, frame}}) == 0);
  CHECK(said.empty());
  CHECK(settled(frame, {{0.0, frame}, {1.0, shorter}}) == 0);
  REQUIRE(said.size() == 1);
  CHECK(said[0].message == "the number of values changes within the shutter; held the frame's 2");
  CHECK(settled(frame, {{0.0, frame}, {1.0, broken}}) == 0);
  CHECK(said.size() == 2);
  CHECK(settled(broken, {{0.0, broken}, {1.0, frame}}) == 0);
  CHECK(said.size() == 2);
}

TEST_CASE("clipping planes have unit normals; what is no plane is left out") {
  std::vector<Diagnostic> said;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::array<double, 4>> given{
      {0, 3, 4, 10}, {0, 0, 0, -1}, {nan, 0, 1, 0}, {1e200, 0, 0, -2e200}, {1e-30, 0, 0, 1e30}};
  const std::vector<ClippingPlane> planes = checked_planes("/cam", given, said);
  REQUIRE(planes.size() == 2);
  CHECK(planes[0].normal == Vec3f{0.0f, 0.6f, 0.8f});
  CHECK(planes[0].offset == 2.0f);
  CHECK(planes[1].normal == Vec3f{1, 0, 0});
  CHECK(planes[1].offset == -2.0f);
  REQUIRE(said.size() == 3);
  CHECK(said[0].message ==
        "found (0, 0, 0, -1), expected finite numbers of which the first three are a direction; left out");
  CHECK(said[1].path == "/cam");
}

TEST_CASE("a scale of motion is a finite number, else the inherited one, with a word") {
  std::vector<Diagnostic> said;
  CHECK(checked_scale({"/mesh"}, 0.5, 2.0, said) == 0.5);
  CHECK(checked_scale({"/mesh"}, 0.0, 2.0, said) == 0.0);
  const double least = -std::numeric_limits<double>::infinity();
  CHECK(checked_scale({"/mesh", "motion:velocityScale", least}, -1.0, 2.0, said) == -1.0);
  CHECK(said.empty());
  CHECK(checked_scale({"/mesh"}, -1.0, 2.0, said) == 2.0);
  REQUIRE(said.size() == 1);
  CHECK(said[0].attribute == "motion:blurScale");
  CHECK(said[0].message == "found -1, expected a finite number of at least 0; took 2");
  CHECK(checked_scale({"/mesh", "motion:velocityScale", least}, std::nan(""), 1.0, said) == 1.0);
  CHECK(said[1].message == "found nan, expected a finite number; took 1");
}

TEST_CASE("a held camera has breakpoints before its jumps too") {
  const std::vector<double> jumps{0.0, 0.25, 0.5};
  CHECK(course_breakpoints01(jumps, false) == jumps);
  CHECK(course_breakpoints01(jumps, true) ==
        std::vector{0.0, 0.25 - kBeforeJump01, 0.25, 0.5 - kBeforeJump01, 0.5});
}
