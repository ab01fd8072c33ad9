// What cameras' optics and lights' inputs mean (delegate/translate/look).
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <tuple>

#include "delegate/translate/look/light_radiance.h"
#include "delegate/translate/look/optics.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/arrays.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/choices.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

using Four = std::tuple<double, double, double, double>;

Four plain(const Window& window) { return {window.left, window.right, window.bottom, window.top}; }

std::tuple<Four, double> conformed_window(const Four& window, double image_aspect,
                                          const std::string& policy) {
  const std::optional<AspectPolicy> known = aspect_policy(policy);
  if (!known) {
    std::string names;
    for (const std::string_view name : aspect_policy_names())
      names += (names.empty() ? "" : ", ") + std::string(name);
    bad_choice("aspectRatioConformPolicy", policy, names.c_str());
  }
  const auto [left, right, bottom, top] = window;
  const Conformed found = conformed({left, right, bottom, top}, image_aspect, *known);
  return {plain(found.window), found.pixel_aspect_ratio};
}

void set_projection(Optics& optics, const std::string& name) { optics.projection = projection_from(name); }

void bind_optics(nb::module_& m) {
  nb::list names;
  for (const std::string_view name : aspect_policy_names()) names.append(std::string(name));
  m.attr("ASPECT_POLICIES") = nb::tuple(names);
  nb::class_<Optics>(m, "Optics")
      .def(nb::init<>())
      .def_prop_rw(
          "projection",
          [](const Optics& o) {
            return o.projection == Projection::kPerspective ? "perspective" : "orthographic";
          },
          &set_projection)
      .def_rw("horizontal_aperture", &Optics::horizontal_aperture)
      .def_rw("vertical_aperture", &Optics::vertical_aperture)
      .def_rw("horizontal_aperture_offset", &Optics::horizontal_aperture_offset)
      .def_rw("vertical_aperture_offset", &Optics::vertical_aperture_offset)
      .def_rw("focal_length", &Optics::focal_length)
      .def_rw("f_stop", &Optics::f_stop)
      .def_rw("focus_distance", &Optics::focus_distance)
      .def_prop_ro("window", [](const Optics& o) { return plain(window_of(o)); })
      .def_prop_ro("lens", [](const Optics& o) {
        const Lens lens = thin_lens(o);
        return std::tuple<float, float>(lens.radius, lens.focus_distance);
      });
  m.def("conformed", &conformed_window, "window"_a, "image_aspect"_a, "policy"_a);
  m.def("image_height", &image_height, "width"_a, "aspect_ratio"_a);
}

LightSizes sizes_from(const Four& sizes) {
  const auto [angle, radius, width, height] = sizes;
  return {angle, radius, width, height};
}

Matrix4d matrix_from(nb::handle matrix) {
  return elements<Matrix4d>(checked_array<double>(matrix, "world_from_light", {4, 4})).front();
}

using Rgb = std::tuple<double, double, double>;

Vec3d color_from(const Rgb& rgb) { return {std::get<0>(rgb), std::get<1>(rgb), std::get<2>(rgb)}; }

Rgb emission(double intensity, double exposure, const Rgb& color, const Rgb& temperature) {
  const Vec3d found = light_emission(intensity, exposure, color_from(color), color_from(temperature));
  return {found.x, found.y, found.z};
}

// Over T times.
nb::object radiances(const std::string& kind, nb::handle emission, nb::handle sizes,
                     const std::vector<bool>& normalize, nb::handle world_from_light) {
  const std::size_t times = normalize.size();
  const AnyArray glow = checked_array<double>(emission, "emission", {times, 3});
  const AnyArray size = checked_array<double>(sizes, "sizes", {times, 4});
  const AnyArray maps = checked_array<double>(world_from_light, "world_from_light", {times, 4, 4});
  std::vector<Vec3d> result;
  for (std::size_t i = 0; i < times; ++i) {
    result.push_back(light_radiance(light_kind_from(kind), elements<Vec3d>(glow)[i],
                                    elements<LightSizes>(size)[i], normalize[i],
                                    elements<Matrix4d>(maps)[i]));
  }
  return owned_array<double>(result, {times, 3});
}

}  // namespace

void bind_look(nb::module_& m) {
  bind_optics(m);
  m.def("light_emission", &emission, "intensity"_a, "exposure"_a, "color"_a, "temperature"_a);
  m.def(
      "light_normalization",
      [](const std::string& kind, const Four& sizes, nb::handle world_from_light) {
        return light_normalization(light_kind_from(kind), sizes_from(sizes), matrix_from(world_from_light));
      },
      "kind"_a, "sizes"_a, "world_from_light"_a);
  m.def("light_radiances", &radiances, "kind"_a, "emission"_a, "sizes"_a, "normalize"_a,
        "world_from_light"_a);
}

}  // namespace msbvh::python
