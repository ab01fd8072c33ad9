// What a film is asked for beside its size: how samples are spread over pixels and the shutter.
#pragma once

#include <cstdint>

#include "core/base/vec.h"
#include "core/film/pixel_filter.h"
#include "core/film/shutter_curve.h"

namespace msbvh {

// Where the frame's time lies in the shutter, for motion at the frame.
struct FrameTime {
  float time01 = 0.0f;          // beyond 0 to 1: the nearer end counts
  float shutter_frames = 0.0f;  // from its opening to its closing; 0: nothing moves
};

inline constexpr std::uint32_t kMostShutterSlices = 64;

struct FilmSettings {
  PixelFilter filter{};
  ShutterCurve shutter_curve{};  // empty: box
  RollingShutter rolling{};
  // Equal parts of the shutter that are kept apart: a power of two up to kMostShutterSlices; 0: none are.
  std::uint32_t shutter_slices = 0;
  FrameTime frame_time{};  // read for AOVs of motion alone
  Vec3d origin{};          // of the frame's world, in the stage's: Pworld counts from there
  // Of the camera: what colours, and the AOVs that are light, are multiplied by. Powers of two change no
  // other bit.
  float exposure = 1.0f;

  // Whether samples lie anywhere but evenly in the pixel and in the shutter.
  bool shapes_samples() const { return !filter.is_pixel() || !shutter_curve.empty() || rolling.share > 0.0f; }
};

// Throws Error naming the setting, found and expected.
void check(const FilmSettings& settings);

}  // namespace msbvh
