#include "delegate/translate/frame/camera_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "delegate/translate/look/shader_values.h"
#include "delegate/translate/sample/even_times.h"

namespace msbvh::translate {
namespace {

constexpr Lens kPinhole{};

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

void check_size(const std::string& path, const char* attribute, double found) {
  if (!positive(found))
    throw Error(message(path, ".", attribute, ": found ", text(found), ", expected a finite number above 0"));
}

void check_offset(const std::string& path, const char* attribute, double found, double largest) {
  if (std::abs(found) <= largest) return;
  throw Error(message(path, ".", attribute, ": found ", text(found), ", expected a finite number of at most ",
                      text(largest), " in size, ", text(kLargestOffset), " times the aperture"));
}

bool is_lens(const std::string& path, const Optics& optics, std::vector<Diagnostic>& diagnostics) {
  const std::pair<const char*, double> values[] = {{"fStop", optics.f_stop},
                                                   {"focusDistance", optics.focus_distance}};
  for (const auto& [attribute, found] : values) {
    if (std::isfinite(found) && found >= 0.0) continue;
    diagnostics.push_back(
        {Severity::kWarning, path, attribute,
         message("found ", text(found), ", expected a finite number of at least 0; everything is in focus")});
    return false;
  }
  return true;
}

ScreenWindow window_in(const Optics& optics, const Framing& framing) {
  const Window whole = conformed(window_of(optics), framing.image_aspect, framing.policy).window;
  const WindowPart& part = framing.part;
  return {float(whole.left + part.left * whole.width()), float(whole.left + part.right * whole.width()),
          float(whole.bottom + part.bottom * whole.height()),
          float(whole.bottom + part.top * whole.height())};
}

bool alike(const CameraSample& a, const CameraSample& b) {
  const auto windows = [](const ScreenWindow& w) { return std::array{w.left, w.right, w.bottom, w.top}; };
  return a.world_from_camera == b.world_from_camera && windows(a.window) == windows(b.window) &&
         a.lens.radius == b.lens.radius && a.lens.focus_distance == b.lens.focus_distance;
}

bool same_clip(const ClipRange& a, const ClipRange& b) {
  return a.near_clip == b.near_clip && a.far_clip == b.far_clip;
}

}  // namespace

void check_optics(const std::string& path, const Optics& optics, const ClipRange& clip) {
  check_size(path, "horizontalAperture", optics.horizontal_aperture);
  check_size(path, "verticalAperture", optics.vertical_aperture);
  if (optics.projection == Projection::kPerspective) check_size(path, "focalLength", optics.focal_length);
  const double largest = kLargestOffset * std::max(optics.horizontal_aperture, optics.vertical_aperture);
  check_offset(path, "horizontalApertureOffset", optics.horizontal_aperture_offset, largest);
  check_offset(path, "verticalApertureOffset", optics.vertical_aperture_offset, largest);
  const Window window = window_of(optics);
  const bool wide = window.left < window.right, high = window.bottom < window.top;
  if (!wide || !high) {
    throw Error(message(path, wide ? ".verticalAperture" : ".horizontalAperture", ": found ",
                        text(wide ? optics.vertical_aperture : optics.horizontal_aperture),
                        ", which is nothing beside its offset of ",
                        text(wide ? optics.vertical_aperture_offset : optics.horizontal_aperture_offset),
                        "; expected more"));
  }
  if (!(clip.near_clip < clip.far_clip)) {
    throw Error(message(path, ".clippingRange: found (", text(double(clip.near_clip)), ", ",
                        text(double(clip.far_clip)), "), expected near < far"));
  }
}

std::vector<Lens> lenses_of(const std::string& path, const Optics& at_frame, std::span<const Optics> over,
                            std::vector<Diagnostic>& diagnostics) {
  const auto is_off = [](const Optics& optics) { return optics.f_stop == 0.0; };
  std::vector<Lens> lenses(over.size(), kPinhole);
  if (is_off(at_frame) && std::ranges::all_of(over, is_off)) return lenses;
  const auto say = [&](Severity severity, const char* attribute, const std::string& words) {
    diagnostics.push_back({severity, path, attribute, words});
  };
  if (at_frame.projection == Projection::kOrthographic) {
    say(Severity::kNote, "fStop",
        message("found ", text(at_frame.f_stop), " on an orthographic camera, which has no depth of field"));
    return lenses;
  }
  if (!is_lens(path, at_frame, diagnostics)) return lenses;
  for (const Optics& optics : over) {
    if (!is_lens(path, optics, diagnostics)) return lenses;
  }
  std::ranges::transform(over, lenses.begin(), thin_lens);
  const auto is_open = [](const Lens& lens) { return lens.radius > 0.0f; };
  const auto open = std::size_t(std::ranges::count_if(lenses, is_open));
  if (open > 0 && open < lenses.size()) {
    say(Severity::kWarning, "fStop",
        "depth of field is on for a part of the shutter only; taken as at the frame");
    std::ranges::fill(lenses, thin_lens(at_frame));
  }
  if (open == 0) {
    say(Severity::kNote, "focusDistance",
        message("found 0, no distance to focus at; everything is in focus in spite of f/",
                text(at_frame.f_stop)));
  }
  return lenses;
}

std::vector<double> course_breakpoints01(std::span<const double> breakpoints01, bool held) {
  std::vector<double> all(breakpoints01.begin(), breakpoints01.end());
  for (const double time01 : breakpoints01) {
    if (held && time01 > kBeforeJump01) all.push_back(time01 - kBeforeJump01);
  }
  std::ranges::sort(all);
  return all;
}

CameraInput camera_input(const std::string& path, const CameraMoment& at_frame,
                         std::span<const CameraMoment> over, std::optional<std::vector<double>> breakpoints01,
                         const Framing& framing, std::vector<Diagnostic>& diagnostics) {
  check_optics(path, at_frame.optics, at_frame.clip);
  std::vector<Optics> optics;
  for (const CameraMoment& moment : over) {
    check_optics(path, moment.optics, moment.clip);
    optics.push_back(moment.optics);
    optics.back().projection = at_frame.optics.projection;  // of the whole shutter
  }
  const std::vector<Lens> lenses = lenses_of(path, at_frame.optics, optics, diagnostics);
  CameraInput camera;
  camera.path = path;
  camera.projection = at_frame.optics.projection;
  camera.breakpoints01 = std::move(breakpoints01);
  camera.near_clip = std::numeric_limits<float>::max();
  camera.far_clip = std::numeric_limits<float>::lowest();
  const bool clips = std::ranges::any_of(
      over, [&](const CameraMoment& moment) { return !same_clip(moment.clip, over.front().clip); });
  for (std::size_t i = 0; i < over.size(); ++i) {
    const CameraMoment& moment = over[i];
    CameraSample sample{moment.time01, moment.world_from_camera, window_in(optics[i], framing), lenses[i]};
    if (clips) sample.clip = moment.clip;
    camera.samples.push_back(sample);
    camera.near_clip = std::min(camera.near_clip, moment.clip.near_clip);
    camera.far_clip = std::max(camera.far_clip, moment.clip.far_clip);
  }
  const bool still = !clips && std::ranges::all_of(camera.samples, [&](const CameraSample& sample) {
    return alike(sample, camera.samples.front());
  });
  if (still && !camera.samples.empty()) camera.samples.resize(1);
  return camera;
}

PixelSize pixel_size_of(const CameraInput& camera, std::uint32_t width, std::uint32_t height) {
  Box3d eyes;
  double per_unit = std::numeric_limits<double>::infinity();
  for (const CameraSample& sample : camera.samples) {
    const Matrix4d& m = sample.world_from_camera;
    eyes.grow(Vec3d{m[12], m[13], m[14]});
    const ScreenWindow& window = sample.window;
    per_unit = std::min({per_unit, std::abs(double(window.right) - window.left) / width,
                         std::abs(double(window.top) - window.bottom) / height});
  }
  const double near = std::max(double(camera.near_clip), 0.0);
  return {eyes, camera.projection == Projection::kPerspective, per_unit, near};
}

std::optional<Projected> projected_by(const Matrix4d& p) {
  const auto all_finite = std::ranges::all_of(p, [](double element) { return std::isfinite(element); });
  if (!all_finite || p[0] == 0.0 || p[5] == 0.0 || p[10] == 0.0) return std::nullopt;
  const bool perspective = p[11] == -1.0 && p[15] == 0.0;
  if (!perspective && !(p[11] == 0.0 && p[15] == 1.0)) return std::nullopt;
  // Where x / w is -1 and 1, at unit distance or anywhere.
  const double x = perspective ? p[8] : -p[12], y = perspective ? p[9] : -p[13];
  Projected result;
  result.projection = perspective ? Projection::kPerspective : Projection::kOrthographic;
  result.window = {float((x - 1.0) / p[0]), float((x + 1.0) / p[0]), float((y - 1.0) / p[5]),
                   float((y + 1.0) / p[5])};
  if (perspective) {
    result.clip = {float(p[14] / (p[10] - 1.0)), float(p[14] / (p[10] + 1.0))};
  } else {
    result.clip = {float((p[14] + 1.0) / p[10]), float((p[14] - 1.0) / p[10])};
  }
  return result;
}

}  // namespace msbvh::translate
