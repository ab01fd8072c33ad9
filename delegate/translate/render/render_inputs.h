// Render settings as a stage authors them: UsdRenderSettings, UsdRenderProduct, UsdRenderVar. What is not
// given is not authored; fallbacks and inheritance are render_spec()'s.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace msbvh::translate {

// A value in a namespace, such as msbvh:seed. std::monostate: of a type that none of ours has.
using SettingValue = std::variant<std::monostate, bool, std::int64_t, double, std::string>;
struct NamedSetting {
  std::string name;
  SettingValue value;
  std::string type{};  // of the value as a stage calls it, for messages
};

// UsdRenderSettingsBase: what settings and each product may say.
struct RenderBaseInput {
  std::string path;                                       // of the prim
  std::string camera;                                     // the path of the camera prim; empty: not authored
  std::optional<std::array<std::int64_t, 2>> resolution;  // width, height
  std::optional<double> pixel_aspect_ratio;               // width of a pixel over its height
  std::optional<std::string> aspect_ratio_conform_policy;
  std::optional<std::array<float, 4>> data_window_ndc;  // xmin, ymin, xmax, ymax; (0, 0) is bottom left
  std::optional<bool> disable_motion_blur, disable_depth_of_field;
  std::optional<bool> instantaneous_shutter;  // deprecated: disableMotionBlur by another name
  std::vector<NamedSetting> settings{};
};

struct RenderVarInput {
  std::string path;
  std::optional<std::string> data_type, source_name, source_type;
};

struct RenderProductInput {
  RenderBaseInput base;
  std::optional<std::string> product_type, product_name;
  std::vector<RenderVarInput> ordered_vars{};
};

struct RenderSettingsInput {
  RenderBaseInput base;
  std::vector<RenderProductInput> products{};
  std::optional<std::vector<std::string>> included_purposes, material_binding_purposes;
  std::optional<std::string> rendering_color_space;
};

}  // namespace msbvh::translate
