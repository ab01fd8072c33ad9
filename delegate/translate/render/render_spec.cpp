#include "delegate/translate/render/render_spec.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string_view>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

constexpr std::string_view kPurposes[] = {"default", "render", "proxy", "guide"};
constexpr std::string_view kFallbackPurposes[] = {"default", "render"};
// Names of the spaces that can be rendered in; the first of each is OpenColorIO's.
constexpr std::string_view kLinearRec709[] = {"lin_rec709_scene", "lin_rec709", "Linear Rec.709 (sRGB)"};
constexpr std::string_view kAcesCg[] = {"acescg", "lin_ap1_scene", "lin_ap1", "ACEScg"};
constexpr double kLargestAspect = 1e4;

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string joined(std::span<const std::string_view> names) {
  std::string all;
  for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  return all;
}

void take_resolution(const RenderBaseInput& input, ProductSpec& product, PrimLog& log) {
  if (!input.resolution) return;
  const auto [width, height] = *input.resolution;
  const auto fits = [](std::int64_t pixels) { return pixels >= 1 && pixels <= kMostPixelsAcross; };
  if (!fits(width) || !fits(height)) {
    log.warn("resolution", message("found (", width, ", ", height, "), expected 1 to ", kMostPixelsAcross,
                                   " pixels each way; ignored"));
    return;
  }
  product.sets_resolution = true;
  product.width = width;
  product.height = height;
}

void take_pixel_aspect(const RenderBaseInput& input, ProductSpec& product, PrimLog& log) {
  if (!input.pixel_aspect_ratio) return;
  const double found = *input.pixel_aspect_ratio;
  if (found >= 1.0 / kLargestAspect && found <= kLargestAspect) {
    product.pixel_aspect_ratio = found;
    return;
  }
  log.warn("pixelAspectRatio", message("found ", text(found), ", expected a number from ",
                                       1.0 / kLargestAspect, " to ", kLargestAspect, "; ignored"));
}

void take_policy(const RenderBaseInput& input, ProductSpec& product, PrimLog& log) {
  if (!input.aspect_ratio_conform_policy) return;
  const std::string& found = *input.aspect_ratio_conform_policy;
  if (const std::optional<AspectPolicy> known = aspect_policy(found)) {
    product.policy = *known;
    return;
  }
  log.warn("aspectRatioConformPolicy",
           message("found '", found, "', expected one of ", joined(aspect_policy_names()), "; ignored"));
}

void take_data_window(const RenderBaseInput& input, ProductSpec& product, PrimLog& log) {
  if (!input.data_window_ndc) return;
  const std::array<float, 4>& found = *input.data_window_ndc;
  const bool finite = std::ranges::all_of(found, [](float edge) { return std::isfinite(edge); });
  if (finite && found[0] < found[2] && found[1] < found[3]) {
    product.data_window_ndc = found;
    return;
  }
  log.warn("dataWindowNDC", message("found (", text(found[0]), ", ", text(found[1]), ", ", text(found[2]),
                                    ", ", text(found[3]),
                                    "), expected finite xmin, ymin, xmax, ymax with xmin < xmax"
                                    " and ymin < ymax; ignored"));
}

// What a prim authores in place of what is there.
void take_base(const RenderBaseInput& input, ProductSpec& product, std::vector<Diagnostic>& diagnostics) {
  PrimLog log(diagnostics, input.path);
  product.path = input.path;
  if (!input.camera.empty()) product.camera = input.camera;
  take_resolution(input, product, log);
  take_pixel_aspect(input, product, log);
  take_policy(input, product, log);
  take_data_window(input, product, log);
  if (input.disable_motion_blur) product.motion_blur = !*input.disable_motion_blur;
  if (input.instantaneous_shutter.value_or(false)) product.motion_blur = false;
  if (input.disable_depth_of_field) product.depth_of_field = !*input.disable_depth_of_field;
}

ProductSpec product_spec(const RenderProductInput& input, const ProductSpec& base,
                         std::vector<Diagnostic>& diagnostics) {
  ProductSpec product = base;
  take_base(input.base, product, diagnostics);
  product.name = input.product_name.value_or("");
  PrimLog log(diagnostics, input.base.path);
  const std::string type = input.product_type.value_or("raster");
  if (type == "deepRaster") {
    log.warn("productType", "found deepRaster, which is not written yet; rendered as raster");
  } else if (type != "raster") {
    log.warn("productType", message("found '", type, "', expected raster or deepRaster; rendered as raster"));
  }
  for (const NamedSetting& setting : input.base.settings) {
    if (setting.name.starts_with("msbvh:"))
      log.warn(setting.name, "found on a render product, expected on the render settings; ignored");
  }
  product.vars = render_vars(input.ordered_vars, diagnostics);
  return product;
}

void take_purposes(const RenderSettingsInput& input, RenderSpec& spec, PrimLog& log) {
  const bool authored = input.included_purposes.has_value();
  spec.sets_purposes = authored;
  if (!authored) {
    spec.included_purposes.assign(std::begin(kFallbackPurposes), std::end(kFallbackPurposes));
    return;
  }
  for (const std::string& purpose : *input.included_purposes) {
    if (is_among(kPurposes, purpose)) {
      spec.included_purposes.push_back(purpose);
    } else {
      log.warn("includedPurposes",
               message("found '", purpose, "', expected any of ", joined(kPurposes), "; ignored"));
    }
  }
  if (std::ranges::find(spec.included_purposes, "default") == spec.included_purposes.end())
    log.warn("includedPurposes", "found no default, which is drawn all the same");
}

// The first counts, and what is bound for all purposes where a prim has no such binding.
void take_material_purposes(const RenderSettingsInput& input, RenderSpec& spec, PrimLog& log) {
  if (!input.material_binding_purposes) return;
  std::vector<std::string> known;
  for (const std::string& purpose : *input.material_binding_purposes) {
    // Exporters write the name of UsdShade's token for the schema's empty string.
    const std::string meant = purpose == "allPurpose" ? "" : purpose;
    if (meant.empty() || meant == "full" || meant == "preview") {
      known.push_back(meant);
    } else {
      log.warn("materialBindingPurposes",
               message("found '", purpose, "', expected full, preview or an empty string; ignored"));
    }
  }
  if (known.empty()) return;
  spec.material_purpose = known.front();
  const bool all_purpose = std::ranges::find(known, "") != known.end();
  if (!all_purpose)
    log.warn("materialBindingPurposes",
             "found no empty string; materials for all purposes are bound all the same");
  const auto others =
      std::ranges::count_if(known, [&](const std::string& each) { return each != "" && each != known[0]; });
  if (others > 0)
    log.warn(
        "materialBindingPurposes",
        message("found more than one purpose, expected one and an empty string; took '", known.front(), "'"));
}

std::string rendering_space(const RenderSettingsInput& input, PrimLog& log) {
  const std::string found = input.rendering_color_space.value_or("");
  if (found.empty()) return {};
  if (is_among(kLinearRec709, found)) return std::string(kLinearRec709[0]);
  if (is_among(kAcesCg, found)) return std::string(kAcesCg[0]);
  log.warn("renderingColorSpace",
           message("found '", found, "', expected ", kLinearRec709[0], " or ", kAcesCg[0], "; ignored"));
  return {};
}

}  // namespace

RenderSpec render_spec(const RenderSettingsInput& input, std::vector<Diagnostic>& diagnostics) {
  RenderSpec spec;
  PrimLog log(diagnostics, input.base.path);
  take_base(input.base, spec.base, diagnostics);
  for (const RenderProductInput& product : input.products)
    spec.products.push_back(product_spec(product, spec.base, diagnostics));
  take_purposes(input, spec, log);
  take_material_purposes(input, spec, log);
  spec.rendering_space = rendering_space(input, log);
  spec.own = own_settings(input.base.settings, input.base.path, diagnostics);
  return spec;
}

PixelWindow pixels_of(const std::array<float, 4>& ndc, const std::string& path, std::int64_t width,
                      std::int64_t height, std::vector<Diagnostic>& diagnostics) {
  if (const auto pixels = pixel_window(ndc, width, height)) return *pixels;
  PrimLog(diagnostics, path)
      .warn("dataWindowNDC",
            message("found (", text(ndc[0]), ", ", text(ndc[1]), ", ", text(ndc[2]), ", ", text(ndc[3]),
                    "), expected one that holds the centres of 1 to ", kMostPixelsAcross,
                    " pixels each way at ", width, " x ", height, "; ignored"));
  return {0, 0, width, height};
}

Conformed conformed_picture(const Window& window, double width, double height, double pixel_aspect_ratio,
                            AspectPolicy policy) {
  if (policy == AspectPolicy::kAdjustPixelAspectRatio) return conformed(window, width / height, policy);
  Conformed found = conformed(window, pixel_aspect_ratio * width / height, policy);
  found.pixel_aspect_ratio = pixel_aspect_ratio;
  return found;
}

}  // namespace msbvh::translate
