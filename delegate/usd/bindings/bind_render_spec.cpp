// What render settings prims ask for: delegate/translate/render.
#include <array>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>
#include <tuple>

#include "delegate/translate/render/render_spec.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/choices.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

using Four = std::tuple<double, double, double, double>;
using Pixels = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

nb::tuple spec_of(const RenderSettingsInput& input) {
  std::vector<Diagnostic> said;
  RenderSpec spec = render_spec(input, said);
  return nb::make_tuple(std::move(spec), said);
}

std::tuple<Four, double> picture(const Four& window, double width, double height, double pixel_aspect_ratio,
                                 const std::string& policy) {
  const std::optional<AspectPolicy> known = aspect_policy(policy);
  if (!known) bad_choice("aspectRatioConformPolicy", policy, "one of ASPECT_POLICIES");
  const auto [left, right, bottom, top] = window;
  const Conformed found =
      conformed_picture({left, right, bottom, top}, width, height, pixel_aspect_ratio, *known);
  const Window& w = found.window;
  return {{w.left, w.right, w.bottom, w.top}, found.pixel_aspect_ratio};
}

nb::tuple pixels(const std::array<float, 4>& ndc, const std::string& path, std::int64_t width,
                 std::int64_t height) {
  std::vector<Diagnostic> said;
  const PixelWindow found = pixels_of(ndc, path, width, height, said);
  return nb::make_tuple(Pixels(found.x, found.y, found.width, found.height), said);
}

Four part(const Pixels& window, std::int64_t width, std::int64_t height) {
  const auto [x, y, w, h] = window;
  const WindowPart found = window_part({x, y, w, h}, width, height);
  return {found.left, found.right, found.bottom, found.top};
}

std::optional<std::string> format_name(const RenderVarSpec& var) {
  if (!var.format) return std::nullopt;
  return *var.format == ChannelFormat::kHalf ? "half" : "float";
}

std::optional<std::string> aov_name(const RenderVarSpec& var) {
  if (!var.aov) return std::nullopt;
  return form_of(*var.aov).name;
}

std::string policy_name(const ProductSpec& product) {
  return std::string(aspect_policy_names()[std::size_t(product.policy)]);
}

void bind_inputs(nb::module_& m) {
  nb::class_<NamedSetting>(m, "NamedSetting")
      .def(
          "__init__",
          [](NamedSetting* self, std::string name, SettingValue value, std::string type) {
            new (self) NamedSetting{std::move(name), std::move(value), std::move(type)};
          },
          "name"_a, "value"_a.none(), "type"_a);
  nb::class_<RenderBaseInput>(m, "RenderBaseInput")
      .def(nb::init<>())
      .def_rw("path", &RenderBaseInput::path)
      .def_rw("camera", &RenderBaseInput::camera)
      .def_rw("resolution", &RenderBaseInput::resolution, nb::arg().none())
      .def_rw("pixel_aspect_ratio", &RenderBaseInput::pixel_aspect_ratio, nb::arg().none())
      .def_rw("aspect_ratio_conform_policy", &RenderBaseInput::aspect_ratio_conform_policy, nb::arg().none())
      .def_rw("data_window_ndc", &RenderBaseInput::data_window_ndc, nb::arg().none())
      .def_rw("disable_motion_blur", &RenderBaseInput::disable_motion_blur, nb::arg().none())
      .def_rw("disable_depth_of_field", &RenderBaseInput::disable_depth_of_field, nb::arg().none())
      .def_rw("instantaneous_shutter", &RenderBaseInput::instantaneous_shutter, nb::arg().none())
      .def_rw("settings", &RenderBaseInput::settings);
}

void bind_product_inputs(nb::module_& m) {
  nb::class_<RenderVarInput>(m, "RenderVarInput")
      .def(
          "__init__",
          [](RenderVarInput* self, std::string path, std::optional<std::string> data_type,
             std::optional<std::string> source_name, std::optional<std::string> source_type) {
            new (self) RenderVarInput{std::move(path), std::move(data_type), std::move(source_name),
                                      std::move(source_type)};
          },
          "path"_a, "data_type"_a.none(), "source_name"_a.none(), "source_type"_a.none());
  nb::class_<RenderProductInput>(m, "RenderProductInput")
      .def(nb::init<>())
      .def_rw("base", &RenderProductInput::base)
      .def_rw("product_type", &RenderProductInput::product_type, nb::arg().none())
      .def_rw("product_name", &RenderProductInput::product_name, nb::arg().none())
      .def_rw("ordered_vars", &RenderProductInput::ordered_vars);
  nb::class_<RenderSettingsInput>(m, "RenderSettingsInput")
      .def(nb::init<>())
      .def_rw("base", &RenderSettingsInput::base)
      .def_rw("products", &RenderSettingsInput::products)
      .def_rw("included_purposes", &RenderSettingsInput::included_purposes, nb::arg().none())
      .def_rw("material_binding_purposes", &RenderSettingsInput::material_binding_purposes, nb::arg().none())
      .def_rw("rendering_color_space", &RenderSettingsInput::rendering_color_space, nb::arg().none());
}

void bind_specs(nb::module_& m) {
  nb::class_<RenderVarSpec>(m, "RenderVarSpec")
      .def_ro("path", &RenderVarSpec::path)
      .def_ro("name", &RenderVarSpec::name)
      .def_prop_ro("aov", &aov_name)
      .def_prop_ro("format", &format_name);
  nb::class_<ProductSpec>(m, "ProductSpec")
      .def_ro("path", &ProductSpec::path)
      .def_ro("name", &ProductSpec::name)
      .def_ro("camera", &ProductSpec::camera)
      .def_ro("sets_resolution", &ProductSpec::sets_resolution)
      .def_ro("width", &ProductSpec::width)
      .def_ro("height", &ProductSpec::height)
      .def_ro("pixel_aspect_ratio", &ProductSpec::pixel_aspect_ratio)
      .def_prop_ro("policy", &policy_name)
      .def_ro("data_window_ndc", &ProductSpec::data_window_ndc)
      .def_ro("motion_blur", &ProductSpec::motion_blur)
      .def_ro("depth_of_field", &ProductSpec::depth_of_field)
      .def_ro("vars", &ProductSpec::vars);
  m.attr("MOST_SAMPLES_OF_NOISE") = kMostSamplesOfNoise;
  nb::class_<OwnSettings>(m, "OwnSettings")
      .def_ro("samples", &OwnSettings::samples)
      .def_ro("seed", &OwnSettings::seed)
      .def_ro("max_bounces", &OwnSettings::max_bounces)
      .def_ro("motion_tolerance", &OwnSettings::motion_tolerance)
      .def_ro("noise", &OwnSettings::noise)
      .def_ro("edge_length", &OwnSettings::edge_length)
      .def_ro("segments", &OwnSettings::segments)
      .def_ro("refraction", &OwnSettings::refraction)
      .def_ro("interpolation", &OwnSettings::interpolation)
      .def_ro("builder", &OwnSettings::builder)
      .def_ro("layout", &OwnSettings::layout);
  nb::class_<RenderSpec>(m, "RenderSpec")
      .def_ro("base", &RenderSpec::base)
      .def_ro("products", &RenderSpec::products)
      .def_ro("sets_purposes", &RenderSpec::sets_purposes)
      .def_ro("included_purposes", &RenderSpec::included_purposes)
      .def_ro("material_purpose", &RenderSpec::material_purpose)
      .def_ro("rendering_space", &RenderSpec::rendering_space)
      .def_ro("own", &RenderSpec::own);
}

}  // namespace

void bind_render_spec(nb::module_& m) {
  bind_inputs(m);
  bind_product_inputs(m);
  bind_specs(m);
  m.def("render_spec", &spec_of, "settings"_a);
  m.def("conformed_picture", &picture, "window"_a, "width"_a, "height"_a, "pixel_aspect_ratio"_a, "policy"_a);
  m.def("pixels_of", &pixels, "data_window_ndc"_a, "path"_a, "width"_a, "height"_a);
  m.def("window_part", &part, "pixels"_a, "width"_a, "height"_a);
}

}  // namespace msbvh::python
