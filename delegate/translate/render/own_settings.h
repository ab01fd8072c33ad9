// Our own settings on a render settings prim, in the namespace msbvh; named as the Hydra plugin's render
// settings are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/render/render_inputs.h"

namespace msbvh::translate {

// Of a pixel, where its noise decides how many it takes and nobody says how many there are at most.
inline constexpr std::uint32_t kMostSamplesOfNoise = 1024;

// What is authored, and makes sense.
struct OwnSettings {
  std::optional<std::int64_t> samples;  // msbvh:samplesPerPixel, at least 1
  std::optional<std::int64_t> seed, max_bounces;
  std::optional<double> motion_tolerance, edge_length;  // pixels
  std::optional<double> noise;                          // msbvh:noise, 0 (off) to 1
  std::optional<std::int64_t> segments;                 // 0 or a power of two
  std::optional<bool> refraction;
  std::optional<std::string> interpolation, builder, layout;
};

// Settings of other namespaces are another renderer's. Unknown names and values that make no sense are
// ignored with a warning. `path`: of the prim.
OwnSettings own_settings(const std::vector<NamedSetting>& settings, const std::string& path,
                         std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
