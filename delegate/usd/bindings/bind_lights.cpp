// What lights' inputs mean, and what they give over the shutter (delegate/translate/look).
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <string>
#include <tuple>
#include <vector>

#include "delegate/translate/look/light_radiance.h"
#include "delegate/translate/look/light_samples.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/arrays.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/choices.h"
#include "delegate/usd/bindings/python_motion.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

using Four = std::tuple<double, double, double, double>;
using Rgb = std::tuple<double, double, double>;

LightSizes sizes_from(const Four& sizes) {
  const auto [angle, radius, width, height] = sizes;
  return {angle, radius, width, height};
}

Matrix4d matrix_from(nb::handle matrix, const char* name) {
  return elements<Matrix4d>(checked_array<double>(matrix, name, {4, 4})).front();
}

Vec3d color_from(const Rgb& rgb) { return {std::get<0>(rgb), std::get<1>(rgb), std::get<2>(rgb)}; }

Rgb emission(double intensity, double exposure, const Rgb& color, const Rgb& temperature) {
  const Vec3d found = light_emission(intensity, exposure, color_from(color), color_from(temperature));
  return {found.x, found.y, found.z};
}

template <typename T>
std::vector<T> vector_from(nb::handle values, const char* name, std::initializer_list<std::size_t> shape) {
  const AnyArray array = checked_array<double>(values, name, shape);
  const std::span<const T> all = elements<T>(array);
  return {all.begin(), all.end()};
}

LightSamples samples_from(nb::handle times01, nb::handle emission, nb::handle sizes,
                          std::vector<bool> normalize) {
  const std::size_t times = normalize.size();
  return {vector_from<double>(times01, "times01", {times}),
          vector_from<Vec3d>(emission, "emission", {times, 3}),
          vector_from<LightSizes>(sizes, "sizes", {times, 4}), std::move(normalize)};
}

std::vector<double> switch_times(nb::handle shown) {
  const std::optional<std::vector<VisibleInterval>> intervals = visible_from(shown);
  return intervals ? switch_times01(*intervals) : std::vector<double>{};
}

// The keywords of Translator.add_light but for name and kind.
nb::dict keywords_of(const LightInput& input) {
  const Light& light = input.light;
  nb::dict keywords;
  keywords["radiance"] = nb::make_tuple(light.radiance.x, light.radiance.y, light.radiance.z);
  keywords["angle_degrees"] = light.angle_degrees;
  keywords["radius"] = light.radius;
  keywords["width"] = light.width;
  keywords["height"] = light.height;
  const TransformSamples& transform = input.world_from_light;
  keywords["times01"] = owned_array<double>(transform.times01, {transform.times01.size()});
  keywords["world_from_light"] = owned_array<double>(transform.matrices, {transform.matrices.size(), 4, 4});
  if (input.values.empty()) return keywords;
  std::vector<Vec3f> radiances;
  std::vector<std::array<float, 4>> sizes;
  for (const LightValues& values : input.values) {
    radiances.push_back(values.radiance);
    sizes.push_back({values.angle_degrees, values.radius, values.width, values.height});
  }
  keywords["values_times01"] = owned_array<double>(input.values_times01, {input.values_times01.size()});
  keywords["radiances"] = owned_array<float>(radiances, {radiances.size(), 3});
  keywords["sizes"] = owned_array<float>(sizes, {sizes.size(), 4});
  return keywords;
}

nb::dict placed(const std::string& kind, const SampledLight& light, nb::handle motion, std::uint32_t index,
                const std::vector<double>& times01, double frame01) {
  return keywords_of(
      placed_light(light_kind_from(kind), light, PythonMotion(motion), index, times01, frame01));
}

void bind_values(nb::module_& m) {
  const LightSizes defaults;
  nb::dict sizes;
  sizes["angle"] = defaults.angle_degrees;
  sizes["radius"] = defaults.radius;
  sizes["width"] = defaults.width;
  sizes["height"] = defaults.height;
  m.attr("LIGHT_SIZES") = sizes;
  m.def("light_emission", &emission, "intensity"_a, "exposure"_a, "color"_a, "temperature"_a);
  m.def(
      "light_normalization",
      [](const std::string& kind, const Four& given, nb::handle world_from_light) {
        return light_normalization(light_kind_from(kind), sizes_from(given),
                                   matrix_from(world_from_light, "world_from_light"));
      },
      "kind"_a, "sizes"_a, "world_from_light"_a);
  m.def(
      "is_similarity", [](nb::handle matrix) { return is_similarity(matrix_from(matrix, "matrix")); },
      "matrix"_a);
}

void bind_samples(nb::module_& m) {
  nb::class_<LightSamples>(m, "LightSamples")
      .def(
          "__init__",
          [](LightSamples* self, nb::handle times01, nb::handle emission, nb::handle sizes,
             std::vector<bool> normalize) {
            new (self) LightSamples(samples_from(times01, emission, sizes, std::move(normalize)));
          },
          "times01"_a, "emission"_a, "sizes"_a, "normalize"_a);
  nb::class_<SampledLight>(m, "SampledLight")
      .def(nb::init<LightSamples>(), "at_frame"_a)
      .def(
          "__init__",
          [](SampledLight* self, const LightSamples& at_frame, const LightSamples& over_shutter,
             std::vector<bool> visible, nb::handle shown) {
            new (self) SampledLight(at_frame, over_shutter, {std::move(visible), visible_from(shown)});
          },
          "at_frame"_a, "over_shutter"_a, "visible"_a, "shown"_a.none());
}

}  // namespace

void bind_lights(nb::module_& m) {
  bind_values(m);
  bind_samples(m);
  m.def("switch_times01", &switch_times, "shown"_a.none());
  m.def(
      "light_times01", [](nb::handle motion, bool held) { return light_times01(PythonMotion(motion), held); },
      "motion"_a, "held"_a);
  m.def("placed_light", &placed, "kind"_a, "light"_a, "motion"_a, "index"_a, "times01"_a, "frame01"_a);
}

}  // namespace msbvh::python
