// What front-ends decide by the same rules before the translator sees a frame: delegate/translate/frame.
#include <array>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <span>
#include <tuple>
#include <vector>

#include "delegate/translate/frame/camera_moments.h"
#include "delegate/translate/frame/clipping_planes.h"
#include "delegate/translate/frame/held_values.h"
#include "delegate/translate/frame/intervals.h"
#include "delegate/translate/frame/motion_scale.h"
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

// (place of the first time, float64[K, 2] or None) each.
nb::list stretches(const std::vector<double>& begins01, const std::vector<std::size_t>& kinds) {
  nb::list result;
  for (const HeldStretch& each : held_stretches(begins01, kinds))
    result.append(nb::make_tuple(each.first, each.shown ? interval_array(*each.shown) : nb::none()));
  return result;
}

nb::tuple scale(const std::string& path, const std::string& attribute, double found, double inherited,
                double least) {
  std::vector<Diagnostic> said;
  const double checked = checked_scale({path, attribute, least}, found, inherited, said);
  return nb::make_tuple(checked, said);
}

// float32[P, 4].
nb::tuple planes(const std::string& path, nb::handle given) {
  const AnyArray array = checked_array<double>(given, "planes", {kAnySize, 4});
  const std::span<const std::array<double, 4>> all = elements<std::array<double, 4>>(array);
  std::vector<Diagnostic> said;
  std::vector<float> values;
  const std::vector<ClippingPlane> checked = checked_planes(path, all, said);
  for (const ClippingPlane& plane : checked)
    values.insert(values.end(), {plane.normal.x, plane.normal.y, plane.normal.z, plane.offset});
  return nb::make_tuple(owned_array<float>(values, {checked.size(), 4}), said);
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
  m.def(
      "course_breakpoints01",
      [](const std::vector<double>& breakpoints01, bool held) {
        return course_breakpoints01(breakpoints01, held);
      },
      "breakpoints01"_a, "held"_a);
  m.def("checked_planes", &planes, "path"_a, "planes"_a);
  m.def("lenses_of", &lenses, "path"_a, "at_frame"_a, "over"_a);
  m.def(
      "intervals_between",
      [](const std::vector<double>& begins01) { return interval_array(intervals_between(begins01)); },
      "begins01"_a);
  m.attr("MOST_STRETCHES") = kMostStretches;
  m.def("held_stretches", &stretches, "begins01"_a, "kinds"_a);
  m.def(
      "knots_within",
      [](const std::vector<double>& authored01, nb::handle shown) {
        return knots_within(authored01, visible_from(shown).value());
      },
      "authored01"_a, "shown"_a);
  m.def("checked_scale", &scale, "path"_a, "attribute"_a, "found"_a, "inherited"_a, "least"_a);
  m.def("common_intervals", &common, "a"_a.none(), "b"_a.none());
}

}  // namespace msbvh::python
