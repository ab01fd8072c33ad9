// Film settings: filters, shutters, and what else is kept of samples.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/film/film_settings.h"
#include "core/film/name_hash.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using Knots = std::vector<std::pair<float, float>>;

PixelFilter filter_from(const std::string& name, std::optional<float> width) {
  std::string known;
  for (const FilterName& filter : kFilters) {
    if (name == filter.name) return {filter.shape, width.value_or(filter.width)};
    known += (known.empty() ? "" : ", ") + std::string(filter.name);
  }
  throw nb::value_error(("pixel_filter: found \"" + name + "\"; expected one of " + known).c_str());
}

nb::tuple to_tuple(const ShutterCurve& curve) {
  nb::list knots;
  for (const Knot& knot : curve) knots.append(nb::make_tuple(knot.place, knot.weight));
  return nb::tuple(knots);
}

ShutterCurve curve_from(const Knots& knots) {
  ShutterCurve curve;
  for (const auto& [time01, weight] : knots) curve.push_back({time01, weight});
  return curve;
}

void init(FilmSettings* self, const std::string& pixel_filter, std::optional<float> filter_width,
          const Knots& shutter_curve, const std::tuple<float, float, float>& rolling,
          const std::pair<float, float>& frame_time, std::uint32_t shutter_slices, float exposure) {
  FilmSettings settings;
  settings.filter = filter_from(pixel_filter, filter_width);
  settings.shutter_curve = curve_from(shutter_curve);
  settings.rolling = {std::get<0>(rolling), std::get<1>(rolling), std::get<2>(rolling)};
  settings.frame_time = {frame_time.first, frame_time.second};
  settings.shutter_slices = shutter_slices;
  settings.exposure = exposure;
  check(settings);
  new (self) FilmSettings(std::move(settings));
}

}  // namespace

void bind_film(nb::module_& m) {
  m.def(
      "name_hash", [](const std::string& name) { return name_hash(name); }, nb::arg("name"));
  nb::list filters;
  for (const FilterName& filter : kFilters) filters.append(filter.name);
  m.attr("PIXEL_FILTERS") = nb::tuple(filters);
  m.attr("MOST_SHUTTER_SLICES") = kMostShutterSlices;
  m.attr("MOST_FILTER_WIDTH") = kMostFilterWidth;
  nb::dict curves;
  curves["box"] = to_tuple(box_curve());
  curves["triangle"] = to_tuple(triangle_curve());
  curves["trapezoid"] = to_tuple(trapezoid_curve());
  m.attr("SHUTTER_CURVES") = curves;
  nb::class_<FilmSettings>(m, "FilmSettings")
      .def("__init__", &init, nb::kw_only(), nb::arg("pixel_filter") = "box",
           nb::arg("filter_width") = nb::none(), nb::arg("shutter_curve") = Knots(),
           nb::arg("rolling") = std::tuple(0.0f, 0.0f, 1.0f), nb::arg("frame_time") = std::pair(0.0f, 0.0f),
           nb::arg("shutter_slices") = 0u, nb::arg("exposure") = 1.0f);
}

}  // namespace msbvh::python
