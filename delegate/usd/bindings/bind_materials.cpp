// Shading networks, attribute by attribute, and what they mean (delegate/translate/look).
#include <nanobind/nanobind.h>
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

#include "core/texture/plain_color.h"
#include "delegate/translate/look/constant_textures.h"
#include "delegate/translate/look/displacement.h"
#include "delegate/translate/look/preview_surface.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

// A function of a resolved file that gives (path, offset, bytes) or None.
class PythonFiles : public TextureSource {
 public:
  explicit PythonFiles(nb::handle locate) : locate_(locate) {}

  std::optional<TextureFile> locate(const std::string& file) const override {
    const nb::object found = locate_(file);
    if (found.is_none()) return std::nullopt;
    using Place = std::tuple<std::string, std::uint64_t, std::uint64_t>;
    const auto [path, offset, bytes] = value_from<Place>(found, "locate()", "(str, int, int) or None");
    return TextureFile{path, offset, bytes};
  }

 private:
  nb::handle locate_;
};

// A function of the files, the colour space and the channel that gives (float32[H, W], wrap modes of the file
// in s and t, which may be empty) or None.
class PythonTexels : public TextureSource {
 public:
  explicit PythonTexels(nb::handle channel) : channel_(channel) {}

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

nb::tuple preview_surface_of(const ShaderNetwork& network, nb::handle locate,
                             const std::string& rendering_space) {
  std::vector<Diagnostic> diagnostics;
  std::optional<SurfaceLook> look = preview_surface(network, PythonFiles(locate), diagnostics);
  if (look) fold_constant_textures(*look, rendering_space);
  return nb::make_tuple(look ? nb::cast(std::move(*look)) : nb::none(), diagnostics);
}

nb::list primvars_of(const SurfaceLook& look) {
  nb::list result;
  for (const NeededPrimvar& each : look.primvars) result.append(nb::make_tuple(each.name, each.width));
  return result;
}

void bind_surface(nb::module_& m) {
  nb::class_<SurfaceLook>(m, "SurfaceLook")
      .def_prop_ro("name", [](const SurfaceLook& look) { return look.material.name; })
      .def_prop_ro("primvars", &primvars_of);
  m.def("preview_surface", &preview_surface_of, "network"_a, "locate"_a, "rendering_space"_a = kLinearRec709);
}

std::vector<std::string> input_names(const std::string& identifier) {
  const std::span<const std::string_view> names = evaluated_inputs(identifier);
  return {names.begin(), names.end()};
}

void bind_values(nb::module_& m) {
  nb::class_<Asset>(m, "Asset")
      .def(nb::init<std::string, std::vector<std::string>, std::string>(), "path"_a, "files"_a,
           "color_space"_a = "")
      .def_ro("color_space", &Asset::color_space)
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
  bind_surface(m);
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
  m.def(
      "surface_rank", [](const std::string& identifier) { return surface_rank(identifier); }, "identifier"_a);
  m.def("evaluated_inputs", &input_names, "identifier"_a);
}

}  // namespace msbvh::python
