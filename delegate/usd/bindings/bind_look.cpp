// What cameras' optics mean (delegate/translate/look).
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "core/texture/plain_color.h"
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

// A copy, float32[N, 3].
nb::object converted_colors(nb::handle given, const std::string& from, const std::string& to) {
  const AnyArray array = checked_array<float>(given, "colors", {kAnySize, 3});
  const std::span<const float> values = elements<float>(array);
  std::vector<float> colors(values.begin(), values.end());
  convert_colors(colors, from, to);
  return owned_array<float>(colors, {colors.size() / 3, 3});
}

void set_projection(Optics& optics, const std::string& name) { optics.projection = projection_from(name); }

}  // namespace

void bind_look(nb::module_& m) {
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
  m.def(
      "exposure_scale",
      [](double stops, double time_seconds, double iso, double f_stop, double responsivity) {
        return exposure_scale({stops, time_seconds, iso, f_stop, responsivity});
      },
      "stops"_a, "time_seconds"_a, "iso"_a, "f_stop"_a, "responsivity"_a);
  m.def("converted_colors", &converted_colors, "colors"_a, "from_space"_a, "to_space"_a);
  m.def("image_height", &image_height, "width"_a, "aspect_ratio"_a);
}

}  // namespace msbvh::python
