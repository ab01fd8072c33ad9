#include "delegate/translate/frame/shutter.h"

#include <algorithm>
#include <cmath>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {

double Shutter::clamped_frame01() const { return moving() ? std::clamp(frame01(), 0.0, 1.0) : 0.0; }

Shutter Shutter::scaled(double blur) const {
  return moving() ? Shutter{blur * open_frames, blur * close_frames} : *this;
}

Shutter checked_shutter(double open_frames, double close_frames, const ShutterSource& source,
                        std::vector<Diagnostic>& diagnostics) {
  const auto say = [&](Severity severity, const std::string& attribute, const std::string& words) {
    diagnostics.push_back({severity, source.path, attribute, words});
  };
  if (!std::isfinite(open_frames) || !std::isfinite(close_frames) ||
      !std::isfinite(close_frames - open_frames)) {
    const std::string both = source.opening + ", " + source.closing;
    say(Severity::kWarning, both,
        message("found ", text(open_frames), " to ", text(close_frames),
                ", expected finite numbers; no motion blur"));
    return {};
  }
  if (close_frames < open_frames) {
    say(Severity::kWarning, source.closing,
        message("found ", text(close_frames), ", before ", source.opening, " at ", text(open_frames),
                ", expected a later time; no motion blur"));
    return {};
  }
  if (close_frames == open_frames) {
    const std::string hint = source.hint.empty() ? "" : "; " + source.hint;
    say(Severity::kNote, source.closing,
        message("equals ", source.opening, ", ", text(open_frames), ": no motion blur", hint));
    return {};
  }
  if (close_frames - open_frames > kAbsurdShutterFrames) {
    say(Severity::kWarning, source.closing,
        message("the shutter is open for ", text(close_frames - open_frames),
                " frames, expected about one; rendered as authored"));
  }
  return {open_frames, close_frames};
}

RateTimes rate_times(const Shutter& shutter, double time_codes_per_second, double velocity_scale) {
  if (!shutter.moving() || !(time_codes_per_second > 0.0)) return {};
  return {shutter.frame01(), shutter.frames() / time_codes_per_second, float(velocity_scale)};
}

}  // namespace msbvh::translate
