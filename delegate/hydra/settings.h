// Render settings: what a host may set, and what is made of it.
#pragma once

#include <pxr/base/vt/value.h>
#include <pxr/imaging/hd/renderDelegate.h>
#include <vector>

#include "core/api/renderer.h"
#include "delegate/hydra/typed_values.h"
#include "delegate/translate/translator.h"

namespace msbvh::hydra {

struct Settings {
  RenderSettings render;  // without size and AOVs
  translate::TranslatorSettings translate;
  bool depth_of_field = true;  // false: cameras are pinholes
};

// For a host's dialogue: names, keys and defaults, which are those of `msbvh record`.
const HdRenderSettingDescriptorList& setting_descriptors();

// An invalid value is ignored, with a warning.
Settings settings_of(const HdRenderDelegate& delegate, Diagnostics& said);

// One of those that are names, by its key; the name is one that is known (translate/render/own_settings.h).
void set_choice(Settings& settings, const TfToken& key, const std::string& name);

// What a host has set of those: hosts set many others, and set them again as they are.
std::vector<VtValue> values_set(const HdRenderDelegate& delegate);

// Of settings in render settings prims: `msbvh:...`.
const TfTokenVector& setting_namespaces();

}  // namespace msbvh::hydra
