// Shading networks, attribute by attribute, and what they mean (delegate/translate/look).
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "delegate/translate/look/displacement.h"
#include "delegate/translate/look/preview_surface.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

// A function of the files and the colour space that gives (r, g, b, a) or None.
class PythonTextures : public TextureSource {
 public:
  explicit PythonTextures(nb::handle mean) : mean_(mean) {}

  std::optional<Rgba> mean(const Asset& texture, std::string_view colour_space) const override {
    const nb::object found = mean_(texture.files, std::string(colour_space));
    return value_from<std::optional<Rgba>>(found, "mean()", "four floats or None");
  }

 private:
  nb::handle mean_;
};

// A function of the files, the colour space and the channel that gives (float32[H, W], wrap modes of the file
// in s and t, which may be empty) or None.
class PythonTexels : public TextureSource {
 public:
  explicit PythonTexels(nb::handle channel) : channel_(channel) {}

  std::optional<Rgba> mean(const Asset&, std::string_view) const override { return std::nullopt; }
  std::optional<ScalarImage> channel(const Asset& texture, std::string_view colour_space,
                                     std::size_t channel) const override {
    const nb::object found = channel_(texture.files, std::string(colour_space), channel);
    if (found.is_none()) return std::nullopt;
    const char* expected = "(float32[H, W], str, str) or None";
    const auto [texels, wrap_s, wrap_t] =
        value_from<std::tuple<nb::object, std::string, std::string>>(found, "channel()", expected);
    const AnyArray array = checked_array<float>(texels, "channel()", {kAnySize, kAnySize});
    if (array.size() == 0) return std::nullopt;
    const std::span<const float> values = elements<float>(array);
    return ScalarImage{std::uint32_t(array.shape(1)),
                       std::uint32_t(array.shape(0)),
                       {values.begin(), values.end()},
                       wrap_s,
                       wrap_t};
  }

 private:
  nb::handle channel_;
};

nb::tuple displacement_of_network(const ShaderNetwork& network, nb::handle channel) {
  std::vector<Diagnostic> diagnostics;
  std::optional<Displacement> found = displacement_of(network, PythonTexels(channel), diagnostics);
  return nb::make_tuple(found ? nb::cast(std::move(*found)) : nb::none(), diagnostics);
}

void bind_displacement(nb::module_& m) {
  nb::class_<Displacement>(m, "Displacement")
      .def_prop_ro("primvar", [](const Displacement& d) { return d.needed_primvar(); })
      .def_prop_ro("primvar_width", [](const Displacement& d) { return d.texture ? 2 : 1; });
  m.def("displacement", &displacement_of_network, "network"_a, "channel"_a);
}

// The keywords of Translator.add_material.
nb::dict keywords_of(const Material& material) {
  const auto tuple_of = [](const Vec3f& rgb) { return nb::make_tuple(rgb.x, rgb.y, rgb.z); };
  nb::dict keywords;
  keywords["name"] = material.name;
  keywords["diffuse_color"] = tuple_of(material.diffuse_color);
  keywords["diffuse_from_display_color"] = material.diffuse_from_display_color;
  keywords["emissive_color"] = tuple_of(material.emissive_color);
  keywords["emissive_from_display_color"] = material.emissive_from_display_color;
  keywords["opacity"] = material.opacity;
  keywords["opacity_from_display_opacity"] = material.opacity_from_display_opacity;
  keywords["opacity_threshold"] = material.opacity_threshold;
  return keywords;
}

nb::tuple preview_surface_of(const ShaderNetwork& network, nb::handle mean) {
  std::vector<Diagnostic> diagnostics;
  const std::optional<Material> material = preview_surface(network, PythonTextures(mean), diagnostics);
  return nb::make_tuple(material ? nb::object(keywords_of(*material)) : nb::none(), diagnostics);
}

std::vector<std::string> input_names(const std::string& identifier) {
  const std::span<const std::string_view> names = evaluated_inputs(identifier);
  return {names.begin(), names.end()};
}

void bind_values(nb::module_& m) {
  nb::class_<Asset>(m, "Asset")
      .def(nb::init<std::string, std::vector<std::string>>(), "path"_a, "files"_a)
      .def_ro("path", &Asset::path)
      .def_ro("files", &Asset::files);
  nb::class_<ShaderValue>(m, "ShaderValue")
      .def(nb::init<ShaderData, std::string, std::string>(), "data"_a.none(), "text"_a, "type"_a)
      .def_ro("data", &ShaderValue::data)
      .def_ro("text", &ShaderValue::text)
      .def_ro("type", &ShaderValue::type);
  nb::class_<ShaderConnection>(m, "ShaderConnection")
      .def(nb::init<std::string, std::string>(), "node"_a, "output"_a)
      .def_ro("node", &ShaderConnection::node)
      .def_ro("output", &ShaderConnection::output);
  nb::class_<Origin>(m, "Origin")
      .def(nb::init<std::string, std::string>(), "path"_a, "attribute"_a)
      .def_ro("path", &Origin::path)
      .def_ro("attribute", &Origin::attribute);
}

}  // namespace

void bind_materials(nb::module_& m) {
  bind_values(m);
  bind_displacement(m);
  nb::class_<ShaderInput>(m, "ShaderInput")
      .def(nb::init<std::string, std::optional<ShaderValue>, std::vector<std::optional<ShaderValue>>,
                    std::vector<ShaderConnection>, std::optional<Origin>>(),
           "name"_a, "value"_a.none() = nb::none(),
           "in_shutter"_a = std::vector<std::optional<ShaderValue>>{},
           "connections"_a = std::vector<ShaderConnection>{}, "origin"_a.none() = nb::none())
      .def_ro("name", &ShaderInput::name)
      .def_ro("value", &ShaderInput::value)
      .def_ro("in_shutter", &ShaderInput::in_shutter)
      .def_ro("connections", &ShaderInput::connections)
      .def_ro("origin", &ShaderInput::origin);
  nb::class_<ShaderNode>(m, "ShaderNode")
      .def(nb::init<std::string, std::string, std::vector<ShaderInput>>(), "path"_a, "identifier"_a,
           "inputs"_a)
      .def_ro("path", &ShaderNode::path)
      .def_ro("identifier", &ShaderNode::identifier)
      .def_ro("inputs", &ShaderNode::inputs);
  nb::class_<ShaderNetwork>(m, "ShaderNetwork")
      .def(nb::init<std::string, std::vector<ShaderNode>, std::map<std::string, ShaderConnection>>(),
           "path"_a, "nodes"_a, "terminals"_a)
      .def_ro("path", &ShaderNetwork::path)
      .def_ro("nodes", &ShaderNetwork::nodes)
      .def_ro("terminals", &ShaderNetwork::terminals);
  m.def("evaluated_inputs", &input_names, "identifier"_a);
  m.def("preview_surface", &preview_surface_of, "network"_a, "mean"_a);
}

}  // namespace msbvh::python
