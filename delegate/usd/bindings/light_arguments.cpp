#include "delegate/usd/bindings/light_arguments.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <string>
#include <tuple>

#include "delegate/translate/look/light_radiance.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/choices.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

Vec3f color_from(const std::tuple<float, float, float>& rgb) {
  return {std::get<0>(rgb), std::get<1>(rgb), std::get<2>(rgb)};
}

TransformSamples transform_from(Arguments& arguments, const char* times, const char* matrices) {
  const std::span<const double> times01 = arguments.times(times);
  return {{times01.begin(), times01.end()}, arguments.matrices(matrices, times01.size()), std::nullopt};
}

// Radiance and numbers (as LIGHT_NUMBERS has them) at times; none: still.
void add_light_samples(Arguments& arguments, LightInput& input) {
  if (arguments.optional("values_times01").is_none()) return;
  const std::span<const double> times01 = arguments.times("values_times01");
  const AnyArray radiances =
      checked_array<float>(arguments.required("radiances"), "radiances", {times01.size(), 3});
  constexpr std::size_t kCount = kLightNumbers.size();
  const AnyArray numbers =
      checked_array<float>(arguments.required("numbers"), "numbers", {times01.size(), kCount});
  input.values_times01.assign(times01.begin(), times01.end());
  for (std::size_t i = 0; i < times01.size(); ++i) {
    LightValues& values = input.values.emplace_back();
    values.radiance = elements<Vec3f>(radiances)[i];
    for (std::size_t n = 0; n < kCount; ++n)
      values.*kLightNumbers[n].value = elements<float>(numbers)[kCount * i + n];
  }
}

MaterialSync material_sync_from(const std::string& name) {
  if (name == "materialGlowTintsLight") return MaterialSync::kGlowTintsLight;
  if (name == "independent") return MaterialSync::kIndependent;
  if (name == "noMaterialResponse") return MaterialSync::kNoMaterial;
  bad_choice("material_sync", name, "materialGlowTintsLight, independent or noMaterialResponse");
}

void add_light_surface(Arguments& arguments, LightInput& input) {
  if (input.light.kind != LightKind::kMesh) return;
  input.surface = {arguments.value<std::string>("surface", "a str"),
                   material_sync_from(arguments.value<std::string>("material_sync", "a str")),
                   arguments.value<bool>("normalize", "a bool")};
}

// Each: size, times01 and world_from_portal.
void add_portals(Arguments& arguments, LightInput& input) {
  const nb::object given = arguments.optional("portals");
  if (given.is_none()) return;
  for (const nb::handle each : given) {
    const auto [width, height, times01, matrices] =
        nb::cast<std::tuple<float, float, nb::object, nb::object>>(each);
    PortalInput& portal = input.portals.emplace_back();
    portal.width = width;
    portal.height = height;
    const AnyArray times = checked_array<double>(times01, "portal times01", {kAnySize});
    const std::span<const double> at = elements<double>(times);
    portal.world_from_portal.times01.assign(at.begin(), at.end());
    const AnyArray array = checked_array<double>(matrices, "world_from_portal", {at.size(), 4, 4});
    const std::span<const Matrix4d> all = elements<Matrix4d>(array);
    portal.world_from_portal.matrices.assign(all.begin(), all.end());
  }
}

}  // namespace

void add_light(Translator& translator, const nb::kwargs& keywords) {
  Arguments arguments(keywords, "add_light");
  LightInput input;
  Light& light = input.light;
  light.name = arguments.value<std::string>("name", "a str");
  light.kind = light_kind_from(arguments.value<std::string>("kind", "a str"));
  light.radiance = color_from(arguments.value<std::tuple<float, float, float>>("radiance", "(r, g, b)"));
  light.angle_degrees = arguments.value<float>("angle_degrees", "a float");
  light.radius = arguments.value<float>("radius", "a float");
  light.width = arguments.value<float>("width", "a float");
  light.height = arguments.value<float>("height", "a float");
  const auto number = [&](const char* name, float& value) {
    if (!arguments.optional(name).is_none()) value = arguments.value<float>(name, "a float");
  };
  number("length", light.length);
  number("focus", light.focus);
  number("cone_angle_degrees", light.cone_angle_degrees);
  number("cone_softness", light.cone_softness);
  number("diffuse", light.diffuse);
  number("specular", light.specular);
  const nb::object look = arguments.optional("look");
  if (!look.is_none()) {
    if (!nb::isinstance<LightLook>(look)) arguments.fail("look", look, "a LightLook");
    static_cast<LightLook&>(light) = *nb::inst_ptr<LightLook>(look);
  }
  input.world_from_light = transform_from(arguments, "times01", "world_from_light");
  add_light_samples(arguments, input);
  add_light_surface(arguments, input);
  add_portals(arguments, input);
  arguments.expect_no_more();
  translator.add_light(input);
}

}  // namespace msbvh::python
