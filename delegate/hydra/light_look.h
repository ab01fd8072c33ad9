// What of a light does not change over the shutter: its image, IES profile, focus tint and shadows.
#pragma once

#include <functional>
#include <string>

#include "delegate/hydra/textures.h"
#include "delegate/hydra/typed_values.h"
#include "delegate/translate/diagnostics.h"

namespace msbvh::hydra {

// A light's parameter at the frame; empty where there is none.
using LightParameter = std::function<VtValue(const TfToken& name)>;

// Links apart. What cannot be read or has no effect is said.
LightLook light_look(const std::string& path, LightKind kind, const LightParameter& parameter,
                     const Textures& textures, Diagnostics& said);

}  // namespace msbvh::hydra
