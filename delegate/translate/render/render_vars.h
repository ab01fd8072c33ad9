// What a UsdRenderVar means here: which AOV of ours, under which name, in which format.
//
//   sourceType      sourceName                                             what is written
//   raw, intrinsic  color, Ci, C, RGBA, rgba, beauty                       colour and alpha
//   lpe             C.*[LO], C[DS]*[LO], with <L.> or <.> in place of L,   colour and alpha: all light that
//                   and with "color" or "lpe:" before it                   comes to the camera
//   raw, intrinsic  depth                                                  depth, 0 to 1 (Hydra's)
//                   cameraDepth, z, Z                                      cameraDepth, scene units
//                   normal, N, Nn; Neye                                    normal in the world; in the camera
//                   every other name of core/film/aov.h                    by that name
//
// An empty sourceName, as the schema's fallback is, means the prim's own name. Primvars and any other light
// path expression are not written.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/film/aov.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/render/render_inputs.h"

namespace msbvh::translate {

// Of the numbers in a file.
enum class ChannelFormat : std::uint8_t { kHalf, kFloat };

struct RenderVarSpec {
  std::string path;
  std::string name;                     // the prim's: layers in files are called so; colour is R, G, B, A
  std::optional<Aov> aov;               // none: colour and alpha
  std::optional<ChannelFormat> format;  // none: dataType says nothing, the file's own default
};

// The names of its channels in a file.
std::vector<std::string> channel_names(const RenderVarSpec& var);

// In their order. What cannot be written, or would have a name that is taken, is left out with a warning.
std::vector<RenderVarSpec> render_vars(const std::vector<RenderVarInput>& ordered,
                                       std::vector<Diagnostic>& diagnostics);

}  // namespace msbvh::translate
