// What AOVs there are.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/film/aov.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

nb::tuple aov_names() {
  nb::list names;
  for (std::size_t i = 0; i < kAovCount; ++i) names.append(form_of(Aov(i)).name);
  return nb::tuple(names);
}

const char* merge_name(AovMerge merge) {
  switch (merge) {
    case AovMerge::kNearest:
      return "nearest";
    case AovMerge::kMean:
      return "mean";
    case AovMerge::kTotal:
      return "total";
    case AovMerge::kError:
      return "error";
    case AovMerge::kCoverage:
      return "coverage";
  }
  return "";
}

nb::dict aov_merges() {
  nb::dict merges;
  for (std::size_t i = 0; i < kAovCount; ++i)
    merges[form_of(Aov(i)).name] = merge_name(form_of(Aov(i)).merge);
  return merges;
}

std::vector<std::string> aov_channels(const std::string& aov, const std::string& layer) {
  const std::optional<Aov> known = aov_named(aov);
  if (!known) throw nb::value_error(("aov: found \"" + aov + "\"; expected one of aov_names()").c_str());
  return channel_names(*known, layer);
}

}  // namespace

std::vector<Aov> aovs_from(const std::vector<std::string>& names) {
  std::vector<Aov> aovs;
  for (const std::string& name : names) {
    const std::optional<Aov> aov = aov_named(name);
    if (!aov)
      throw Error(std::string("render settings: aovs: found '")
                      .append(name)
                      .append("'; expected one of aov_names()"));
    aovs.push_back(*aov);
  }
  return aovs;
}

void bind_aovs(nb::module_& m) {
  m.def("aov_names", &aov_names);
  m.def("aov_merges", &aov_merges);
  m.def("aov_channels", &aov_channels, nb::arg("aov"), nb::arg("layer"));
}

}  // namespace msbvh::python
