#include "core/film/film_settings.h"

#include <bit>
#include <cmath>
#include <sstream>

#include "core/base/error.h"

namespace msbvh {
namespace {

template <typename T>
[[noreturn]] void refuse(const char* setting, const T& found, const char* expected) {
  std::ostringstream text;
  text << "render settings: " << setting << ": found " << found << "; expected " << expected;
  throw Error(text.str());
}

bool is_share(float x) { return x >= 0.0f && x <= 1.0f; }

}  // namespace

void check(const FilmSettings& settings) {
  const float width = settings.filter.width;
  if (!(width > 0.0f && width <= kMostFilterWidth))
    refuse("filter width", width, "more than 0 and at most 4 pixels");
  const ShutterCurve& curve = settings.shutter_curve;
  if (!curve.empty()) {
    if (!is_density(curve))
      refuse("shutter curve", "weights that are no density",
             "times that do not decrease, finite weights from 0 on, some above 0");
    if (!is_share(curve.front().place) || !is_share(curve.back().place))
      refuse("shutter curve", "times beyond the shutter", "times from 0 to 1");
  }
  const RollingShutter& rolling = settings.rolling;
  const std::uint32_t slices = settings.shutter_slices;
  if (slices != 0 && (slices > kMostShutterSlices || !std::has_single_bit(slices)))
    refuse("shutter slices", slices, "0 or a power of two up to 64");
  if (slices != 0 && (!curve.empty() || settings.rolling.share > 0.0f))
    refuse("shutter slices", "them with a shutter curve or a rolling shutter, which move samples in time",
           "neither");
  const float frames = settings.frame_time.shutter_frames;
  if (!(frames >= 0.0f && std::isfinite(frames) && std::isfinite(settings.frame_time.time01)))
    refuse("frame time", frames, "a finite number of frames from 0 on");
  if (!(settings.exposure >= 0.0f && std::isfinite(settings.exposure)))
    refuse("exposure", settings.exposure, "a finite number from 0 on");
  if (!is_share(rolling.share)) refuse("rolling shutter", rolling.share, "a share of the shutter, 0 to 1");
}

}  // namespace msbvh
