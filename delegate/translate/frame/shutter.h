// The open shutter of a frame.
#pragma once

#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// A shutter that is open for longer is taken as authored, with a warning: one exporter writes the length of
// the shot.
inline constexpr double kAbsurdShutterFrames = 16.0;

// Times are in frames (time codes), relative to the frame that is rendered.
struct Shutter {
  double open_frames = 0.0, close_frames = 0.0;

  bool operator==(const Shutter&) const = default;
  // Whether it is open for any time at all.
  bool moving() const { return close_frames > open_frames; }
  double frames() const { return close_frames - open_frames; }
  // A closed shutter has one time, 0, at the frame.
  double time01(double frames_after) const {
    return moving() ? (frames_after - open_frames) / frames() : 0.0;
  }
  double frames_at(double time01) const {
    return moving() ? (1.0 - time01) * open_frames + time01 * close_frames : 0.0;
  }
  // The frame's own time, which may lie outside of the shutter; and the shutter's end next to it then.
  double frame01() const { return time01(0.0); }
  double clamped_frame01() const;
  // Of a prim with that motion:blurScale: scaled about the frame (UsdGeomMotionAPI).
  Shutter scaled(double blur) const;
};

// Where a shutter comes from, for messages.
struct ShutterSource {
  std::string path{};                    // of the camera
  std::string opening = "shutter:open";  // the attributes
  std::string closing = "shutter:close";
  std::string hint{};  // how to open one that is closed; empty: nobody can
};

// Closed where the times make no sense, with a warning that says what was found. A shutter that closes when
// it opens is no fault: a note says that nothing is blurred.
Shutter checked_shutter(double open_frames, double close_frames, const ShutterSource& source,
                        std::vector<Diagnostic>& diagnostics);

// What turns rates into positions over a shutter. `time_codes_per_second` is the stage's.
RateTimes rate_times(const Shutter& shutter, double time_codes_per_second, double velocity_scale = 1.0);

}  // namespace msbvh::translate
