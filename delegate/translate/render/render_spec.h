// What render settings ask for: each product with what it inherits, as UsdRenderComputeSpec (OpenUSD,
// usdRender/spec.cpp) has it. A value that makes no sense is ignored with a warning, and what is weaker
// counts: the settings' own, then the schema's fallback.
//
// instantaneousShutter turns motion blur off, as UsdRender documents; OpenUSD's spec.cpp (24.11) reads
// disableMotionBlur twice in its place.
#pragma once

#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/optics.h"
#include "delegate/translate/render/data_window.h"
#include "delegate/translate/render/own_settings.h"
#include "delegate/translate/render/render_inputs.h"
#include "delegate/translate/render/render_vars.h"

namespace msbvh::translate {

// One picture.
struct ProductSpec {
  std::string path;    // of the product; of the settings where they name no product
  std::string name;    // productName as authored: nothing says that it is a path that may be written
  std::string camera;  // empty: none is named
  bool sets_resolution = false;              // authored by one of the two, not the schema's fallback
  std::int64_t width = 2048, height = 1080;  // of the display window, in pixels
  double pixel_aspect_ratio = 1.0;           // as authored; conformed() may say another
  AspectPolicy policy = AspectPolicy::kExpandAperture;
  std::array<float, 4> data_window_ndc{0.0f, 0.0f, 1.0f, 1.0f};
  bool motion_blur = true, depth_of_field = true;
  std::vector<RenderVarSpec> vars{};  // none: colour
};

struct RenderSpec {
  ProductSpec base;  // what the settings say themselves
  std::vector<ProductSpec> products;
  bool sets_purposes = false;
  std::vector<std::string> included_purposes;  // default, render, proxy, guide
  std::string material_purpose = "full";       // full, preview, or empty for allPurpose; weaker: allPurpose
  std::string rendering_space{};  // OpenColorIO's name; empty: nothing that is known is asked for
  OwnSettings own{};
};

RenderSpec render_spec(const RenderSettingsInput& input, std::vector<Diagnostic>& diagnostics);

// The pixels of a data window in a picture of that size. A window that holds no pixel's centre is ignored
// with a warning that names `path`, the prim that asks for it.
PixelWindow pixels_of(const std::array<float, 4>& ndc, const std::string& path, std::int64_t width,
                      std::int64_t height, std::vector<Diagnostic>& diagnostics);

// The camera's window that a picture of width x height pixels of that aspect ratio shows, with the pixels' as
// the policy leaves it: adjustPixelAspectRatio disregards the one that is given.
Conformed conformed_picture(const Window& window, double width, double height, double pixel_aspect_ratio,
                            AspectPolicy policy);

}  // namespace msbvh::translate
