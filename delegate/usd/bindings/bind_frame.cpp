// What front-ends decide by the same rules before the translator sees a frame: delegate/translate/frame.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <tuple>
#include <vector>

#include "delegate/translate/frame/camera_moments.h"
#include "delegate/translate/frame/intervals.h"
#include "delegate/translate/frame/shutter.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/arrays.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

// float64[K, 2].
nb::object interval_array(const std::vector<VisibleInterval>& intervals) {
  std::vector<double> ends;
  for (const VisibleInterval& part : intervals) ends.insert(ends.end(), {part.begin01, part.end01});
  return owned_array<double>(ends, {intervals.size(), 2});
}

nb::tuple shutter(double open_frames, double close_frames, const std::string& camera,
                  const std::string& hint) {
  ShutterSource source{camera};
  source.hint = hint;
  std::vector<Diagnostic> said;
  const Shutter found = checked_shutter(open_frames, close_frames, source, said);
  return nb::make_tuple(std::tuple(found.open_frames, found.close_frames), said);
}

// float32[T, 2]: radius and focus distance.
nb::tuple lenses(const std::string& path, const Optics& at_frame, const std::vector<Optics>& over) {
  std::vector<Diagnostic> said;
  std::vector<float> values;
  for (const Lens& lens : lenses_of(path, at_frame, over, said))
    values.insert(values.end(), {lens.radius, lens.focus_distance});
  return nb::make_tuple(owned_array<float>(values, {over.size(), 2}), said);
}

nb::object common(nb::handle a, nb::handle b) {
  const Visibility both = common_intervals(visible_from(a), visible_from(b));
  return both ? interval_array(*both) : nb::none();
}

}  // namespace

void bind_frame(nb::module_& m) {
  m.attr("ABSURD_SHUTTER_FRAMES") = kAbsurdShutterFrames;
  m.def("checked_shutter", &shutter, "open_frames"_a, "close_frames"_a, "camera"_a, "hint"_a);
  m.def(
      "check_optics",
      [](const std::string& path, const Optics& optics, float near_clip, float far_clip) {
        check_optics(path, optics, {near_clip, far_clip});
      },
      "path"_a, "optics"_a, "near_clip"_a, "far_clip"_a);
  m.def("lenses_of", &lenses, "path"_a, "at_frame"_a, "over"_a);
  m.def(
      "intervals_between",
      [](const std::vector<double>& begins01) { return interval_array(intervals_between(begins01)); },
      "begins01"_a);
  m.def("common_intervals", &common, "a"_a.none(), "b"_a.none());
}

}  // namespace msbvh::python
