// The plan of a scene, without trees: who asks for which effect, and the geometry that each holds.
#include <cstddef>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <string>
#include <vector>

#include "core/api/renderer.h"
#include "core/plan/effect_bytes.h"
#include "core/plan/effect_plan.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

nb::dict effect_row(Effect effect, const std::vector<Reason>& reasons, const EffectBytes& bytes) {
  nb::list asked_by;
  for (const Reason& reason : reasons) {
    if (reason.effect == effect) asked_by.append(nb::make_tuple(reason.prim, reason.why));
  }
  nb::dict row;
  row["effect"] = effect_name(effect);
  row["asked_by"] = asked_by;
  row["geometry_bytes"] = bytes[effect];
  return row;
}

nb::dict effects(const SceneHandle& scene, std::uint32_t max_bounces, const std::string& aovs,
                 bool refraction) {
  std::vector<Reason> reasons;
  EffectBytes bytes;
  {
    const nb::gil_scoped_release release;
    validate(*scene.scene);
    reasons = all_reasons(*scene.scene, {.max_bounces = max_bounces, .aovs = aovs, .refraction = refraction});
    bytes = effect_bytes(*scene.scene);
  }
  nb::list rows;
  for (std::size_t i = 0; i < kEffectCount; ++i) rows.append(effect_row(effect_at(i), reasons, bytes));
  nb::dict found;
  found["base_bytes"] = bytes.base;
  found["effects"] = rows;
  return found;
}

}  // namespace

void bind_plan(nb::module_& m) {
  m.def("effects", &effects, nb::arg("scene"), nb::kw_only(),
        nb::arg("max_bounces") = RenderSettings{}.max_bounces, nb::arg("aovs") = "",
        nb::arg("refraction") = false);
}

}  // namespace msbvh::python
