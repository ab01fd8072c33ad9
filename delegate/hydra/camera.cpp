#include "delegate/hydra/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <pxr/base/gf/camera.h>
#include <pxr/imaging/hd/cameraSchema.h>

#include "core/base/error.h"
#include "delegate/hydra/motion_source.h"
#include "delegate/hydra/render_param.h"
#include "delegate/translate/frame/clipping_planes.h"
#include "delegate/translate/frame/held_values.h"
#include "delegate/translate/sample/even_times.h"

namespace msbvh::hydra {
namespace {

using translate::AspectPolicy;
using translate::CameraMoment;
using translate::Optics;

AspectPolicy policy_of(CameraUtilConformWindowPolicy policy) {
  switch (policy) {
    case CameraUtilMatchVertically:
      return AspectPolicy::kAdjustApertureWidth;
    case CameraUtilMatchHorizontally:
      return AspectPolicy::kAdjustApertureHeight;
    case CameraUtilCrop:
      return AspectPolicy::kCropAperture;
    case CameraUtilDontConform:
      return AspectPolicy::kAdjustPixelAspectRatio;
    default:
      return AspectPolicy::kExpandAperture;
  }
}

// Hydra counts apertures, offsets and focal lengths in units of the scene, USD in tenths of them.
Optics in_tenths(Optics optics) {
  optics.horizontal_aperture /= GfCamera::APERTURE_UNIT;
  optics.vertical_aperture /= GfCamera::APERTURE_UNIT;
  optics.horizontal_aperture_offset /= GfCamera::APERTURE_UNIT;
  optics.vertical_aperture_offset /= GfCamera::APERTURE_UNIT;
  optics.focal_length /= GfCamera::FOCAL_LENGTH_UNIT;
  return optics;
}

Projection projection_of(HdCamera::Projection projection) {
  return projection == HdCamera::Orthographic ? Projection::kOrthographic : Projection::kPerspective;
}

CameraMoment synced_moment(const HdCamera& camera) {
  Optics optics;
  optics.projection = projection_of(camera.GetProjection());
  optics.horizontal_aperture = double(camera.GetHorizontalAperture());
  optics.vertical_aperture = double(camera.GetVerticalAperture());
  optics.horizontal_aperture_offset = double(camera.GetHorizontalApertureOffset());
  optics.vertical_aperture_offset = double(camera.GetVerticalApertureOffset());
  optics.focal_length = double(camera.GetFocalLength());
  optics.f_stop = double(camera.GetFStop());
  optics.focus_distance = double(camera.GetFocusDistance());
  const GfRange1f& clip = camera.GetClippingRange();
  return {0.0, matrix_of(camera.GetTransform()), in_tenths(optics), {clip.GetMin(), clip.GetMax()}};
}

// How far from the frame values are compared with those at the frame, in frames.
constexpr float kCloseToFrame = 1.0f / 1024.0f;

// Whether lengths off the frame are counted in tenths, as USD does, though those at the frame are not: so
// they come from UsdImagingDelegate, which samples attributes as they are authored.
bool counts_tenths_off_frame(HdFloatDataSource& length, double unit) {
  const auto at_frame = double(length.GetTypedValue(0.0f)),
             close = double(length.GetTypedValue(kCloseToFrame));
  return at_frame != 0.0 && std::abs(close * unit / at_frame - 1.0) < 0.05;
}

// The attributes of a camera that change within the shutter.
class MovingOptics {
 public:
  MovingOptics(HdCameraSchema schema, const Shutter& shutter) {
    add(schema.GetHorizontalAperture(), &Optics::horizontal_aperture, shutter);
    add(schema.GetVerticalAperture(), &Optics::vertical_aperture, shutter);
    add(schema.GetHorizontalApertureOffset(), &Optics::horizontal_aperture_offset, shutter);
    add(schema.GetVerticalApertureOffset(), &Optics::vertical_aperture_offset, shutter);
    add(schema.GetFocalLength(), &Optics::focal_length, shutter);
    add(schema.GetFStop(), &Optics::f_stop, shutter);
    add(schema.GetFocusDistance(), &Optics::focus_distance, shutter);
    const HdVec2fDataSourceHandle clip = schema.GetClippingRange();
    if (clip && contributing_offsets(*clip, shutter).size() > 1) clip_ = clip;
    const HdFloatDataSourceHandle focal_length = schema.GetFocalLength();
    tenths_off_frame_ = focal_length && counts_tenths_off_frame(*focal_length, GfCamera::FOCAL_LENGTH_UNIT);
  }

  std::vector<double> breakpoints01(const Shutter& shutter) const {
    std::vector<double> found;
    const auto add_times = [&](HdSampledDataSource& source) {
      for (const float offset : contributing_offsets(source, shutter))
        found.push_back(shutter.time01(double(offset)));
    };
    for (const auto& [source, member] : numbers_) add_times(*source);
    if (clip_) add_times(*clip_);
    return found;
  }

  // Whether each sample holds until the next.
  bool held(const Shutter& shutter) const {
    return std::any_of(numbers_.begin(), numbers_.end(), [&](const auto& number) {
      std::vector<double> offsets;
      for (const float offset : contributing_offsets(*number.first, shutter))
        offsets.push_back(double(offset));
      return translate::holds_between(
          offsets, [&](double offset) { return number.first->GetTypedValue(float(offset)); });
    });
  }

  // `still` has the values of what does not change.
  CameraMoment at(double time01, const Shutter& shutter, const CameraMoment& still) const {
    const auto offset = float(shutter.frames_at(time01));
    Optics optics = still.optics;
    for (const auto& [source, member] : numbers_) {
      Optics found;
      found.*member = double(source->GetTypedValue(offset));
      if (offset == 0.0f || !tenths_off_frame_) found = in_tenths(found);
      optics.*member = found.*member;
    }
    CameraMoment moment{time01, still.world_from_camera, optics, still.clip};
    if (clip_) {
      const GfVec2f clip = clip_->GetTypedValue(offset);
      moment.clip = {clip[0], clip[1]};
    }
    return moment;
  }

 private:
  using Member = double Optics::*;

  void add(const HdFloatDataSourceHandle& source, Member member, const Shutter& shutter) {
    if (source && contributing_offsets(*source, shutter).size() > 1) numbers_.emplace_back(source, member);
  }

  std::vector<std::pair<HdFloatDataSourceHandle, Member>> numbers_;
  HdVec2fDataSourceHandle clip_;
  bool tenths_off_frame_ = false;
};

std::vector<double> inside_shutter(std::vector<double> times01) {
  std::erase_if(times01, [](double time01) { return !(time01 > 0.0 && time01 < 1.0); });
  std::sort(times01.begin(), times01.end());
  times01.erase(std::unique(times01.begin(), times01.end()), times01.end());
  return times01;
}

// As densely as a camera is sampled everywhere.
std::vector<CameraMoment> moments_over(HdSceneDelegate& delegate, const SdfPath& path, const Shutter& shutter,
                                       const CameraMoment& at_frame, std::vector<double>& breakpoints01) {
  const MotionPointer motion = transform_motion(delegate, path, shutter);
  const MovingOptics optics(HdCameraSchema::GetFromParent(scene_index_prim(delegate, path)), shutter);
  breakpoints01 = motion->breakpoints01();
  const std::vector<double> zooms = optics.breakpoints01(shutter);
  breakpoints01.insert(breakpoints01.end(), zooms.begin(), zooms.end());
  breakpoints01 = inside_shutter(std::move(breakpoints01));
  const bool held = motion->held() || optics.held(shutter);
  std::vector<double> times01{0.0};
  if (shutter.moving() && (!motion->still() || !zooms.empty())) {
    const double turns = motion->turns(0).rate();
    times01 = translate::dense_times01(translate::Density::kCamera, turns, breakpoints01, held);
  }
  breakpoints01 = translate::course_breakpoints01(breakpoints01, held);
  const std::vector<translate::Matrix4d> matrices = translate::matrices_at(*motion, times01);
  std::vector<CameraMoment> moments;
  for (std::size_t i = 0; i < times01.size(); ++i) {
    moments.push_back(optics.at(times01[i], shutter, at_frame));
    moments.back().world_from_camera = matrices[i];
  }
  return moments;
}

void add_planes(const HdRenderPassState& state, translate::CameraInput& camera, Diagnostics& said) {
  std::vector<std::array<double, 4>> planes;
  for (const GfVec4d& plane : state.GetClipPlanes())
    planes.push_back({plane[0], plane[1], plane[2], plane[3]});
  camera.clipping_planes = translate::checked_planes(camera.path, planes, said);
}

// Of hosts that set matrices and no camera.
translate::CameraInput from_matrices(const HdRenderPassState& state, const ImageFrame& image) {
  const auto shown = translate::projected_by(matrix_of(state.GetProjectionMatrix()));
  if (!shown)
    throw Error("render pass: found a projection matrix that is neither perspective nor orthographic");
  translate::CameraInput camera;
  camera.path = "render pass";
  camera.projection = shown->projection;
  camera.near_clip = shown->clip.near_clip;
  camera.far_clip = shown->clip.far_clip;
  const ScreenWindow& window = shown->window;
  const translate::WindowPart& part = image.framing.part;
  const double width = double(window.right - window.left), height = double(window.top - window.bottom);
  translate::CameraSample sample;
  sample.world_from_camera = matrix_of(state.GetWorldToViewMatrix().GetInverse());
  sample.window = {float(window.left + part.left * width), float(window.left + part.right * width),
                   float(window.bottom + part.bottom * height), float(window.bottom + part.top * height)};
  camera.samples.push_back(sample);
  return camera;
}

const Camera* camera_of(const HdRenderPassState& state) {
  return dynamic_cast<const Camera*>(state.GetCamera());
}

}  // namespace

void Camera::Sync(HdSceneDelegate* delegate, HdRenderParam* param, HdDirtyBits* bits) {
  const bool changed = (*bits & HdCamera::AllDirty) != 0;
  HdCamera::Sync(delegate, param, bits);
  delegate_ = delegate;
  if (changed) static_cast<RenderParam*>(param)->note_camera();
}

ImageFrame image_frame(const HdRenderPassState& state) {
  const CameraUtilFraming& framing = state.GetFraming();
  ImageFrame image;
  image.framing.policy = policy_of(state.GetWindowPolicy());
  if (!framing.IsValid()) {
    const GfVec4f& viewport = state.GetViewport();
    image.width = std::uint32_t(std::max(viewport[2], 0.0f));
    image.height = std::uint32_t(std::max(viewport[3], 0.0f));
    image.data_window = GfRect2i(GfVec2i(0), int(image.width), int(image.height));
    image.framing.image_aspect = image.height ? double(image.width) / image.height : 1.0;
    return image;
  }
  const GfRange2f& display = framing.displayWindow;
  const GfRect2i& data = framing.dataWindow;
  const double width = double(display.GetSize()[0]), height = double(display.GetSize()[1]);
  image.data_window = data;
  image.width = std::uint32_t(std::max(data.GetMaxX() + 1, 0));
  image.height = std::uint32_t(std::max(data.GetMaxY() + 1, 0));
  image.framing.image_aspect = double(framing.pixelAspectRatio) * width / height;
  // CameraUtilFraming counts y downwards, from the upper edge.
  const double left = double(display.GetMin()[0]), top = double(display.GetMin()[1]);
  image.framing.part = {(data.GetMinX() - left) / width, (data.GetMaxX() + 1 - left) / width,
                        1.0 - (data.GetMaxY() + 1 - top) / height, 1.0 - (data.GetMinY() - top) / height};
  return image;
}

float exposure_of(const HdRenderPassState& state) {
#if MSBVH_CAMERAS_EXPOSE
  if (const HdCamera* camera = state.GetCamera()) {
    const float scale = camera->GetLinearExposureScale();
    return scale >= 0.0f && std::isfinite(scale) ? scale : 1.0f;
  }
#endif
  return 1.0f;
}

Shutter shutter_of(const HdRenderPassState& state, Diagnostics& said) {
  const HdCamera* camera = state.GetCamera();
  if (!camera) return {};
  return translate::checked_shutter(camera->GetShutterOpen(), camera->GetShutterClose(),
                                    {camera->GetId().GetString()}, said);
}

translate::CameraInput camera_input(const HdRenderPassState& state, const Shutter& shutter,
                                    const ImageFrame& image, Diagnostics& said) {
  const HdCamera* camera = state.GetCamera();
  if (!camera) return from_matrices(state, image);
  const std::string path = camera->GetId().GetString();
  const CameraMoment at_frame = synced_moment(*camera);
  const Camera* ours = camera_of(state);
  std::optional<std::vector<double>> breakpoints01;
  std::vector<CameraMoment> moments{at_frame};
  if (ours && ours->delegate())
    moments = moments_over(*ours->delegate(), camera->GetId(), shutter, at_frame, breakpoints01.emplace());
  translate::CameraInput input =
      translate::camera_input(path, at_frame, moments, breakpoints01, image.framing, said);
  add_planes(state, input, said);
  return input;
}

}  // namespace msbvh::hydra
