#include "delegate/translate/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "core/motion/bezier.h"
#include "core/motion/bezier_fit.h"
#include "delegate/translate/blur.h"
#include "delegate/translate/camera_motion.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/time_layout.h"
#include "delegate/translate/time_samples.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

constexpr double kShareOfTolerance = 0.1;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Depths at which projected points are compared, in multiples of the near distance (orthographic: of the
// window's width); infinity comes on top.
constexpr double kDepths[] = {1.0, 10.0, 100.0, 1000.0};

// By how much a clip plane is out: the share of its distance, for an orthographic camera of the window's
// width, times the image's width. So far off are edges that it cuts at a flat angle.
double clip_pixels(const CameraInstant& truth, const CameraInstant& track, const CameraInput& camera,
                   const TranslatorSettings& settings) {
  if (!camera.samples.front().clip) return 0.0;
  const double window = std::abs(truth.window.right - truth.window.left);
  const bool perspective = camera.projection == Projection::kPerspective;
  const auto share = [&](double a, double b) { return std::abs(a - b) / (perspective ? a : window); };
  const ClipD &a = truth.clip, &b = track.clip;
  return settings.width * std::max(share(a.near_clip, b.near_clip), share(a.far_clip, b.far_clip));
}

// How far apart, in pixels, two cameras see what the first one sees at a place of its window and a depth: the
// rays through the lens's centre, and by how much the rim's rays differ from them.
class ProjectionDifference {
 public:
  ProjectionDifference(const CameraInstant& truth, const CameraInstant& track,
                       const TranslatorSettings& settings, bool perspective)
      : truth_(truth),
        window_(track.window),
        lens_(track.lens),
        track_from_truth_(inverse(track.world_from_camera) * truth.world_from_camera),
        settings_(settings),
        perspective_(perspective) {}

  double window_width() const { return std::abs(window_.right - window_.left); }
  double pixels(double x01, double y01, double depth) const {
    const Vec3d point = camera_point(truth_.window, x01, y01, depth, perspective_);
    const Vec3d seen = std::isinf(depth) ? track_from_truth_.vector(point) : track_from_truth_.point(point);
    if (perspective_ && !(seen.z < 0.0)) return std::numeric_limits<double>::infinity();
    const double divisor = perspective_ ? -seen.z : 1.0;
    const double x = (seen.x / divisor - window_.left) / (window_.right - window_.left);
    const double y = (seen.y / divisor - window_.bottom) / (window_.top - window_.bottom);
    return std::hypot((x - x01) * settings_.width, (y - y01) * settings_.height);
  }

  // Of the blur's size: the first camera's and the second's, each on its own window.
  double blur_pixels(double depth) const {
    const double truth = truth_.lens.blur_radius(depth), track = lens_.blur_radius(depth);
    const auto difference = [&](double truth_size, double track_size, double pixels) {
      return pixels * std::abs(truth / truth_size - track / track_size);
    };
    return std::max(
        difference(truth_.window.right - truth_.window.left, window_.right - window_.left, settings_.width),
        difference(truth_.window.top - truth_.window.bottom, window_.top - window_.bottom, settings_.height));
  }

 private:
  CameraInstant truth_;
  WindowD window_;
  LensD lens_;
  Affine3d track_from_truth_;
  const TranslatorSettings& settings_;
  bool perspective_;
};

double instant_error(const ProjectionDifference& difference, const CameraInput& camera) {
  const bool perspective = camera.projection == Projection::kPerspective;
  const double unit = perspective ? camera.near_clip : difference.window_width();
  std::vector<double> depths;
  for (const double multiple : kDepths) depths.push_back(multiple * unit);
  if (perspective) depths.push_back(std::numeric_limits<double>::infinity());
  double worst = 0.0;
  for (const double depth : depths) {
    double at_depth = 0.0;
    for (const double x01 : {0.0, 0.5, 1.0}) {
      for (const double y01 : {0.0, 0.5, 1.0}) {
        at_depth = std::max(at_depth, difference.pixels(x01, y01, depth));
      }
    }
    worst = std::max(worst, at_depth + (perspective ? difference.blur_pixels(depth) : 0.0));
  }
  return worst;
}

// What a Camera accepts, between controls and at them.
bool is_usable(const CameraInstant& c) {
  return !is_singular(c.world_from_camera) && c.window.left != c.window.right &&
         c.window.bottom != c.window.top && c.lens.radius >= 0.0 && c.lens.focus_distance > 0.0 &&
         c.clip.near_clip < c.clip.far_clip;
}

double segment_error(const CameraMotion& motion, const CameraInput& camera,
                     const TranslatorSettings& settings, const LayoutSegment& segment, std::uint32_t degree,
                     double limit) {
  const bool perspective = camera.projection == Projection::kPerspective;
  const std::vector<CameraInstant> controls = motion.controls(segment, degree);
  if (!std::ranges::all_of(controls, is_usable)) return kInfinite;
  double worst = 0.0;
  for (const double time01 : test_times01(segment, degree, motion.breakpoints(), motion.times01())) {
    const double w = (time01 - segment.begin01) / (segment.end01 - segment.begin01);
    const CameraInstant track = bezier([&](std::uint32_t i) { return controls[i]; }, degree, w);
    if (is_singular(track.world_from_camera)) return kInfinite;
    const CameraInstant truth = motion.at(time01);
    worst = std::max({worst, instant_error({truth, track, settings, perspective}, camera),
                      clip_pixels(truth, track, camera, settings)});
    if (worst > limit) break;
  }
  return worst;
}

// By how much a motion fails to repeat.
double period_error(const CameraMotion& motion, const CameraInput& camera, const TranslatorSettings& settings,
                    double period01, double limit) {
  const bool perspective = camera.projection == Projection::kPerspective;
  double worst = 0.0;
  const auto compare = [&](double time01) {
    const CameraInstant first = motion.at(time01 - period01 * std::floor(time01 / period01));
    worst = std::max(worst, instant_error({motion.at(time01), first, settings, perspective}, camera));
  };
  compare(1.0);
  for (const double time01 : motion.times01()) {
    if (worst > limit) break;
    if (time01 > period01 && time01 < 1.0) compare(time01);
  }
  return worst;
}

double track_error(const CameraMotion& motion, const CameraInput& camera, const TranslatorSettings& settings,
                   const Candidate& track, double limit) {
  double repeated = 0.0;
  if (track.layout.repeats()) {
    repeated = period_error(motion, camera, settings, track.layout.period01(), limit);
    if (repeated > limit) return repeated;
  }
  double worst = 0.0;
  for (std::uint32_t i = 0; i < track.layout.segments() && worst <= limit - repeated; ++i) {
    const LayoutSegment segment = track.layout.segment(i);
    worst = std::max(worst, segment_error(motion, camera, settings, segment, track.degree, limit - repeated));
  }
  return repeated + worst;
}

// Where a camera sees a point of the world, in pixels; far away where it is behind it.
Vec3d seen(const CameraInstant& camera, const Vec3d& point, const TranslatorSettings& settings,
           bool perspective) {
  constexpr double kBehind = 1e6;
  const Vec3d p = inverse(camera.world_from_camera).point(point);
  if (perspective && !(p.z < 0.0)) return {kBehind, kBehind, 0.0};
  const double divisor = perspective ? -p.z : 1.0;
  const WindowD& w = camera.window;
  return {(p.x / divisor - w.left) / (w.right - w.left) * settings.width,
          (p.y / divisor - w.bottom) / (w.top - w.bottom) * settings.height, 0.0};
}

// Of points that fill the image at the shutter's centre.
double track_blur(const CameraMotion& motion, const CameraInput& input, const TranslatorSettings& settings,
                  const Candidate& track) {
  const bool perspective = input.projection == Projection::kPerspective;
  std::vector<std::vector<CameraInstant>> controls;
  for (std::uint32_t i = 0; i < track.layout.segments(); ++i) {
    controls.push_back(motion.controls(track.layout.segment(i), track.degree));
    if (!std::ranges::all_of(controls.back(), is_usable)) return kInfinite;
  }
  const CameraInstant centre = motion.at(0.5);
  const double depth = 10.0 * (perspective ? input.near_clip : 1.0);
  double worst = 0.0;
  for (const auto& [x01, y01] : {std::pair{0.5, 0.5}, {0.1, 0.1}, {0.9, 0.1}, {0.1, 0.9}, {0.9, 0.9}}) {
    const Vec3d point =
        centre.world_from_camera.point(camera_point(centre.window, x01, y01, depth, perspective));
    std::vector<Vec3d> truth, shown;
    for (std::size_t t = 0; t < kBlurTimes; ++t) {
      const PlaceInLayout place = locate(track.layout, blur_time01(t));
      const auto& c = controls[place.segment];
      const CameraInstant at = bezier([&](std::uint32_t k) { return c[k]; }, track.degree, place.w);
      truth.push_back(seen(motion.at(blur_time01(t)), point, settings, perspective));
      shown.push_back(seen(at, point, settings, perspective));
    }
    worst = std::max(worst, blur_distance(truth, shown));
  }
  return worst;
}

// From the pose at the shutter's centre.
double still_error(const CameraMotion& motion, const CameraInput& camera,
                   const TranslatorSettings& settings) {
  const bool perspective = camera.projection == Projection::kPerspective;
  const CameraInstant centre = motion.at(0.5);
  double worst = 0.0;
  for (const double time01 : test_times(motion.times01(), 0)) {
    const CameraInstant truth = motion.at(time01);
    worst = std::max({worst, instant_error({truth, centre, settings, perspective}, camera),
                      clip_pixels(truth, centre, camera, settings)});
  }
  return worst;
}

struct CameraFit {
  Candidate track{TimeLayout::even(0), 1};
  double error = 0.0;
};

CameraFit cheapest(const CameraMotion& motion, const CameraInput& input, const TranslatorSettings& settings) {
  const double tolerance = kShareOfTolerance * settings.motion_tolerance_pixels;
  CameraFit result;
  result.error = still_error(motion, input, settings);
  if (result.error <= kStillShare * tolerance) return result;
  std::vector<Candidate> tracks = candidates(
      motion.breakpoints(), {tolerance, settings.max_segments, settings.choice}, motion.periods01());
  const CandidateFit fit = cheapest_candidate(
      tracks, tolerance,
      [&](std::size_t i, double limit) { return track_error(motion, input, settings, tracks[i], limit); },
      [&](std::size_t i) { return track_blur(motion, input, settings, tracks[i]); });
  return {std::move(tracks[fit.index]), fit.error};
}

void add_control(const CameraInstant& at, bool open, bool clips, Camera& camera) {
  camera.world_from_camera.push_back(Affine3f(at.world_from_camera));
  camera.window.push_back(
      {float(at.window.left), float(at.window.right), float(at.window.bottom), float(at.window.top)});
  if (open) camera.lens.push_back({float(at.lens.radius), float(at.lens.focus_distance)});
  if (clips) camera.clip.push_back({float(at.clip.near_clip), float(at.clip.far_clip)});
}

[[noreturn]] void fail(const CameraInput& camera, const std::string& attribute, const std::string& what) {
  throw Error(message(camera.path, ".", attribute, ": ", what));
}

void check_sample(const CameraInput& camera, const CameraSample& sample) {
  const Affine3d map = affine_from(sample.world_from_camera);
  if (!is_representable(map) || is_singular(map)) {
    fail(camera, "xformOpOrder",
         message("the matrix ", at_shutter_time(sample.time01),
                 " is singular, not finite or too large; expected an invertible one"));
  }
  const ScreenWindow& w = sample.window;
  const bool finite =
      std::isfinite(w.left) && std::isfinite(w.right) && std::isfinite(w.bottom) && std::isfinite(w.top);
  if (!finite || w.left == w.right || w.bottom == w.top) {
    fail(camera, "horizontalAperture",
         message("the window ", at_shutter_time(sample.time01), " is ", w.left, " to ", w.right, " by ",
                 w.bottom, " to ", w.top, "; expected finite sides of a size that is not zero"));
  }
}

void check_lens(const CameraInput& camera, const CameraSample& sample) {
  const Lens& lens = sample.lens;
  if (!std::isfinite(lens.radius) || lens.radius < 0.0f) {
    fail(camera, "fStop",
         message("the lens radius ", at_shutter_time(sample.time01), " is ", lens.radius,
                 "; expected a finite number of at least 0"));
  }
  if (!std::isfinite(lens.focus_distance) || lens.focus_distance <= 0.0f) {
    fail(camera, "focusDistance",
         message("found ", lens.focus_distance, " ", at_shutter_time(sample.time01),
                 "; expected a finite number above 0"));
  }
  if (lens.radius > 0.0f && camera.projection == Projection::kOrthographic) {
    fail(camera, "fStop", "an orthographic camera has a lens; expected none: its rays are parallel");
  }
}

void check_clip(const CameraInput& camera, const ClipRange& clip, const std::string& when) {
  const bool perspective = camera.projection == Projection::kPerspective;
  const bool increases = std::isfinite(clip.near_clip) && clip.near_clip < clip.far_clip;
  if (increases && !(perspective && clip.near_clip <= 0.0f)) return;
  const char* expected = perspective ? "; expected 0 < near < far" : "; expected near < far";
  fail(camera, "clippingRange", message("found ", clip.near_clip, " to ", clip.far_clip, when, expected));
}

}  // namespace

void check_camera(const CameraInput& camera) {
  std::vector<double> times01;
  for (const CameraSample& sample : camera.samples) times01.push_back(sample.time01);
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, camera.path);
  if (!check_times(times01, "shutter", log)) fail(camera, diagnostics[0].attribute, diagnostics[0].message);
  check_clip(camera, {camera.near_clip, camera.far_clip}, "");
  const bool clips = camera.samples.front().clip.has_value();
  for (const CameraSample& sample : camera.samples) {
    check_sample(camera, sample);
    check_lens(camera, sample);
    if (sample.clip.has_value() != clips) {
      fail(camera, "clippingRange", "found in some samples only; expected in all or in none");
    }
    if (clips) check_clip(camera, *sample.clip, " " + at_shutter_time(sample.time01));
  }
}

Vec3d frame_origin(const CameraInput& camera) {
  return CameraMotion(camera, {}).at(key_time(0, 0)).world_from_camera.t;
}

Camera fit_camera(const CameraInput& input, const Vec3d& origin, const TranslatorSettings& settings,
                  TrackReport& track) {
  const CameraMotion motion(input, origin);
  const CameraFit fit = cheapest(motion, input, settings);
  const TrackForm form = fit.track.form();
  track.path = input.path;
  track.set_form(form, fit.track.layout.time_remap());
  track.moving_transform = form.moving();
  track.error_pixels = fit.error;
  track.bytes = form.controls() * (sizeof(Affine3f) + sizeof(ScreenWindow));

  Camera camera;
  camera.name = input.path;
  camera.projection = input.projection;
  camera.clipping_planes = input.clipping_planes;
  camera.near_clip = input.near_clip;
  camera.far_clip = input.far_clip;
  camera.segments = form.segments;
  camera.degree = form.degree;
  camera.time_remap = fit.track.layout.time_remap();
  const bool open = std::any_of(input.samples.begin(), input.samples.end(),
                                [](const CameraSample& sample) { return sample.lens.radius > 0.0f; });
  const bool clips = input.samples.front().clip.has_value();
  if (!form.moving()) add_control(motion.at(0.5), open, clips, camera);
  for (std::uint32_t i = 0; i < form.segments; ++i) {
    const std::vector<CameraInstant> controls = motion.controls(fit.track.layout.segment(i), form.degree);
    for (std::uint32_t c = i == 0 ? 0 : 1; c < controls.size(); ++c) {
      add_control(controls[c], open, clips, camera);
    }
  }
  return camera;
}

}  // namespace msbvh::translate
