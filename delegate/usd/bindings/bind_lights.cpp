// What lights' inputs mean, and what they give over the shutter (delegate/translate/look).
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <string>
#include <tuple>
#include <vector>

#include "delegate/translate/look/ies_file.h"
#include "delegate/translate/look/light_picture.h"
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

using Rgb = std::tuple<double, double, double>;

// In the order of kLightNumbers; those at the end may be left out.
LightNumbers numbers_from(const std::vector<double>& given) {
  if (given.size() > kLightNumbers.size()) throw nb::value_error("numbers: found too many");
  LightNumbers numbers;
  for (std::size_t i = 0; i < given.size(); ++i) numbers.*kLightNumbers[i].number = given[i];
  return numbers;
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

LightSamples samples_from(nb::handle times01, nb::handle emission, nb::handle numbers,
                          std::vector<bool> normalize) {
  const std::size_t times = normalize.size();
  return {vector_from<double>(times01, "times01", {times}),
          vector_from<Vec3d>(emission, "emission", {times, 3}),
          vector_from<LightNumbers>(numbers, "numbers", {times, kLightNumbers.size()}), std::move(normalize)};
}
static_assert(sizeof(LightNumbers) == kLightNumbers.size() * sizeof(double));

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
  keywords["length"] = light.length;
  keywords["focus"] = light.focus;
  keywords["cone_angle_degrees"] = light.cone_angle_degrees;
  keywords["cone_softness"] = light.cone_softness;
  keywords["diffuse"] = light.diffuse;
  keywords["specular"] = light.specular;
  const TransformSamples& transform = input.world_from_light;
  keywords["times01"] = owned_array<double>(transform.times01, {transform.times01.size()});
  keywords["world_from_light"] = owned_array<double>(transform.matrices, {transform.matrices.size(), 4, 4});
  if (input.values.empty()) return keywords;
  std::vector<Vec3f> radiances;
  std::vector<std::array<float, kLightNumbers.size()>> numbers;
  for (const LightValues& values : input.values) {
    radiances.push_back(values.radiance);
    for (auto& row = numbers.emplace_back(); const LightNumber& each : kLightNumbers)
      row[std::size_t(&each - kLightNumbers.data())] = values.*each.value;
  }
  keywords["values_times01"] = owned_array<double>(input.values_times01, {input.values_times01.size()});
  keywords["radiances"] = owned_array<float>(radiances, {radiances.size(), 3});
  keywords["numbers"] = owned_array<float>(numbers, {numbers.size(), kLightNumbers.size()});
  return keywords;
}

nb::dict placed(const std::string& kind, const SampledLight& light, nb::handle motion, std::uint32_t index,
                const std::vector<double>& times01, double frame01) {
  return keywords_of(
      placed_light(light_kind_from(kind), light, PythonMotion(motion), index, times01, frame01));
}

void bind_values(nb::module_& m) {
  nb::dict numbers;
  for (const LightNumber& each : kLightNumbers) numbers[each.input] = LightNumbers{}.*each.number;
  m.attr("LIGHT_NUMBERS") = numbers;
  m.def("light_emission", &emission, "intensity"_a, "exposure"_a, "color"_a, "temperature"_a);
  m.def(
      "light_normalization",
      [](const std::string& kind, const std::vector<double>& given, nb::handle world_from_light) {
        return light_normalization(light_kind_from(kind), numbers_from(given),
                                   matrix_from(world_from_light, "world_from_light"));
      },
      "kind"_a, "numbers"_a, "world_from_light"_a);
  m.def(
      "is_similarity", [](nb::handle matrix) { return is_similarity(matrix_from(matrix, "matrix")); },
      "matrix"_a);
}

void bind_samples(nb::module_& m) {
  nb::class_<LightSamples>(m, "LightSamples")
      .def(
          "__init__",
          [](LightSamples* self, nb::handle times01, nb::handle emission, nb::handle numbers,
             std::vector<bool> normalize) {
            new (self) LightSamples(samples_from(times01, emission, numbers, std::move(normalize)));
          },
          "times01"_a, "emission"_a, "numbers"_a, "normalize"_a);
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

using ProfilePointer = std::shared_ptr<const IesProfile>;

LightPicture picture_from(const std::string& name, const std::string& map, nb::handle texels) {
  const auto array = nb::cast<nb::ndarray<nb::numpy, const float, nb::ndim<3>, nb::c_contig>>(texels);
  if (array.shape(2) != 3) throw nb::value_error("texels: expected float32[H, W, 3]");
  const auto* first = reinterpret_cast<const Vec3f*>(array.data());
  return light_picture(name, image_map_from(map), std::uint32_t(array.shape(1)),
                       std::uint32_t(array.shape(0)), {first, first + array.shape(0) * array.shape(1)});
}

Vec3f float_color_from(const Rgb& rgb) { return Vec3f(color_from(rgb)); }

// LightLook's settings, each a property, so that the reader says only what a light has.
void bind_light_look(nb::module_& m) {
  nb::class_<LightPicture>(m, "LightPicture")
      .def_prop_ro(
          "size",
          [](const LightPicture& picture) { return std::tuple(picture.image->width, picture.image->height); })
      .def_ro("mended", &LightPicture::mended);
  m.def("light_picture", &picture_from, "name"_a, "map"_a, "texels"_a);
  nb::class_<IesProfile>(m, "IesProfile").def_ro("power", &IesProfile::power);
  m.def(
      "ies_profile",
      [](nb::bytes text) {
        return std::make_shared<const IesProfile>(parse_ies({text.c_str(), text.size()}));
      },
      "text"_a);
  nb::class_<LightLook>(m, "LightLook")
      .def(nb::init<>())
      .def(
          "set_image", [](LightLook& look, const LightPicture& picture) { look.image = picture.image; },
          "picture"_a)
      .def(
          "set_focus_tint",
          [](LightLook& look, const Rgb& tint) { look.focus_tint = float_color_from(tint); }, "tint"_a)
      .def(
          "set_ies",
          [](LightLook& look, ProfilePointer profile, float angle_scale, bool normalize) {
            look.ies = {std::move(profile), angle_scale, normalize};
          },
          "profile"_a, "angle_scale"_a, "normalize"_a)
      .def(
          "set_shadow",
          [](LightLook& look, bool enable, const Rgb& color, float distance, float falloff, float gamma) {
            look.shadow = {enable, float_color_from(color), distance, falloff, gamma};
          },
          "enable"_a, "color"_a, "distance"_a, "falloff"_a, "falloff_gamma"_a)
      .def(
          "set_links",
          [](LightLook& look, const std::vector<bool>& lit, const std::vector<bool>& shadowed) {
            look.lit_groups.assign(lit.begin(), lit.end());
            look.shadow_groups.assign(shadowed.begin(), shadowed.end());
          },
          "lit"_a, "shadowed"_a)
      .def_prop_ro("has_image", [](const LightLook& look) { return look.image != nullptr; })
      .def_prop_ro("has_ies", [](const LightLook& look) { return look.ies.profile != nullptr; })
      .def_prop_ro("links", [](const LightLook& look) {
        return std::tuple(std::vector<bool>(look.lit_groups.begin(), look.lit_groups.end()),
                          std::vector<bool>(look.shadow_groups.begin(), look.shadow_groups.end()));
      });
}

}  // namespace

void bind_lights(nb::module_& m) {
  bind_values(m);
  bind_light_look(m);
  bind_samples(m);
  m.def("switch_times01", &switch_times, "shown"_a.none());
  m.def(
      "light_times01", [](nb::handle motion, bool held) { return light_times01(PythonMotion(motion), held); },
      "motion"_a, "held"_a);
  m.def("placed_light", &placed, "kind"_a, "light"_a, "motion"_a, "index"_a, "times01"_a, "frame01"_a);
}

}  // namespace msbvh::python
