// How densely motion is sampled, and what says how far things turn.
#include <algorithm>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "delegate/translate/sample/even_times.h"
#include "delegate/translate/sample/sampler.h"
#include "delegate/translate/sample/value_times.h"
#include "delegate/translate/time_layout.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/arrays.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/python_motion.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

std::vector<Box3d> boxes_from(nb::handle array) {
  const AnyArray ends = checked_array<double>(array, "boxes", {kAnySize, 2, 3});
  std::vector<Box3d> boxes;
  const std::span<const Vec3d> corners = elements<Vec3d>(ends);
  for (std::size_t i = 0; i < corners.size(); i += 2) boxes.push_back({corners[i], corners[i + 1]});
  return boxes;
}

std::vector<MotionSamples> sampled(nb::handle motion, nb::handle boxes, const PixelSize& pixel_size,
                                   double tolerance_pixels, bool held) {
  return sample_motion(PythonMotion(motion), boxes_from(boxes), pixel_size, tolerance_pixels, held);
}

PixelSize pixel_size(nb::handle camera_box, bool perspective, double per_unit, double near) {
  const AnyArray ends = checked_array<double>(camera_box, "camera_box", {2, 3});
  const std::span<const Vec3d> corners = elements<Vec3d>(ends);
  return PixelSize({corners[0], corners[1]}, perspective, per_unit, near);
}

// The smallest size at each of N things over T times, whose boxes have these corners: float64[T, N, 8, 3].
nb::object at_boxes(const PixelSize& pixel_size, nb::handle corners) {
  const AnyArray array = checked_array<double>(corners, "corners", {kAnySize, kAnySize, 8, 3});
  const std::size_t things = array.shape(1);
  std::vector<Box3d> boxes(things);
  const std::span<const Vec3d> points = elements<Vec3d>(array);
  for (std::size_t i = 0; i < points.size(); ++i) boxes[i / 8 % things].grow(points[i]);
  std::vector<double> sizes;
  for (const Box3d& box : boxes) sizes.push_back(pixel_size.at_box(box));
  return owned_array<double>(sizes, {things});
}

std::vector<double> flattened(const std::vector<std::vector<double>>& rows) {
  std::vector<double> all;
  for (const std::vector<double>& row : rows) {
    if (row.size() != rows.front().size()) throw nb::value_error("values: expected as many each time");
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

Turns turns_of_angles(const std::vector<double>& times01, const std::vector<std::vector<double>>& degrees,
                      const std::vector<double>& loop_periods01) {
  if (degrees.size() != times01.size()) throw nb::value_error("degrees: expected one row a time");
  const std::size_t axes = degrees.empty() ? 0 : degrees.front().size();
  return angle_turns(times01, flattened(degrees), axes, loop_periods01);
}

// Rows of (i, j, k, real).
Turns turns_of_orientations(const std::vector<double>& times01,
                            const std::vector<std::vector<double>>& rows) {
  std::vector<Quatd> orientations;
  for (const std::vector<double>& row : rows) {
    if (row.size() != 4) throw nb::value_error("orientations: expected four numbers each");
    orientations.push_back({row[0], row[1], row[2], row[3]});
  }
  if (orientations.size() != times01.size()) throw nb::value_error("orientations: expected one a time");
  return orientation_turns(times01, orientations);
}

// float64[T, J, 4] of (i, j, k, real).
Turns turns_of_joints(const std::vector<double>& times01, nb::handle rotations,
                      const std::vector<int>& parents) {
  const AnyArray array = checked_array<double>(rotations, "rotations", {times01.size(), parents.size(), 4});
  return joint_turns(times01, elements<Quatd>(array), parents);
}

void bind_turns(nb::module_& m) {
  nb::class_<Turns>(m, "Turns")
      .def(nb::init<>())
      .def(nb::init<std::vector<double>, std::vector<double>, std::vector<double>>(), "times01"_a, "total"_a,
           "periods01"_a = std::vector<double>{})
      .def("__add__", &Turns::operator+, "other"_a)
      .def_prop_ro("times01", &Turns::times01)
      .def_prop_ro("total", &Turns::total)
      .def_prop_ro("periods01", &Turns::periods01)
      .def_prop_ro("rate", &Turns::rate)
      .def_prop_ro("none", &Turns::none)
      .def("at", &Turns::at, "time01"_a)
      .def(
          "within",
          [](const Turns& turns, const std::vector<double>& ends01) { return turns.within(ends01); },
          "ends01"_a);
  m.def("uniform_turns", &uniform_turns, "turns"_a);
  m.def("angle_turns", &turns_of_angles, "times01"_a, "degrees"_a,
        "loop_periods01"_a = std::vector<double>{});
  m.def("joint_turns", &turns_of_joints, "times01"_a, "rotations"_a, "parents"_a);
  m.def("orientation_turns", &turns_of_orientations, "times01"_a, "orientations"_a);
  m.def(
      "usable_periods01", [](const std::vector<double>& all) { return usable_periods01(all); },
      "periods01"_a);
}

TransformSamples transform_samples(nb::handle times01, nb::handle matrices,
                                   std::optional<std::vector<double>> breakpoints01, bool held,
                                   double error_pixels, std::vector<double> periods01) {
  const AnyArray times = checked_array<double>(times01, "times01", {kAnySize});
  const AnyArray array = checked_array<double>(matrices, "matrices", {times.shape(0), 4, 4});
  const std::span<const double> all_times = elements<double>(times);
  const std::span<const Matrix4d> all = elements<Matrix4d>(array);
  return {{all_times.begin(), all_times.end()},
          {all.begin(), all.end()},
          std::move(breakpoints01),
          held,
          error_pixels,
          std::move(periods01)};
}

void bind_transforms(nb::module_& m) {
  nb::class_<TransformSamples>(m, "TransformSamples")
      .def(
          "__init__",
          [](TransformSamples* self, nb::handle times01, nb::handle matrices,
             std::optional<std::vector<double>> breakpoints01, bool held, double error_pixels,
             std::vector<double> periods01) {
            new (self) TransformSamples(transform_samples(times01, matrices, std::move(breakpoints01), held,
                                                          error_pixels, std::move(periods01)));
          },
          "times01"_a, "matrices"_a, "breakpoints01"_a.none() = nb::none(), "held"_a = false,
          "error_pixels"_a = 0.0, "periods01"_a = std::vector<double>{})
      .def_prop_ro(
          "times01", [](const TransformSamples& s) { return view<double>(s.times01, {s.times01.size()}); },
          nb::rv_policy::reference_internal)
      .def_prop_ro(
          "matrices",
          [](const TransformSamples& s) {
            return view<double>(s.matrices, {s.matrices.size(), 4, 4});
          },
          nb::rv_policy::reference_internal)
      .def_ro("breakpoints01", &TransformSamples::breakpoints01)
      .def_ro("held", &TransformSamples::held)
      .def_ro("error_pixels", &TransformSamples::error_pixels)
      .def_ro("periods01", &TransformSamples::periods01);
}

void bind_samples(nb::module_& m) {
  nb::class_<MotionSamples>(m, "MotionSamples")
      .def_prop_ro("indices", [](const MotionSamples& s) { return index_array(s.which); })
      .def_prop_ro(
          "times01", [](const MotionSamples& s) { return view<double>(s.times01, {s.times01.size()}); },
          nb::rv_policy::reference_internal)
      .def_prop_ro(
          "matrices",
          [](const MotionSamples& s) {
            return view<double>(s.matrices, {s.times01.size(), s.which.size(), 4, 4});
          },
          nb::rv_policy::reference_internal)
      .def_prop_ro(
          "breakpoints01",
          [](const MotionSamples& s) { return view<double>(s.breakpoints01, {s.breakpoints01.size()}); },
          nb::rv_policy::reference_internal)
      .def_ro("held", &MotionSamples::held)
      .def_ro("error_pixels", &MotionSamples::error_pixels)
      .def_ro("periods01", &MotionSamples::periods01)
      .def_ro("usable", &MotionSamples::usable)
      .def("of", &MotionSamples::of, "place"_a);
  m.def("sample_motion", &sampled, "motion"_a, "boxes"_a, "pixel_size"_a, "tolerance_pixels"_a, "held"_a);
}

void bind_times(nb::module_& m) {
  nb::enum_<Density>(m, "Density")
      .value("CAMERA", Density::kCamera)
      .value("LIGHT", Density::kLight)
      .value("GLANCE", Density::kGlance);
  m.def(
      "even_times01",
      [](int level, const std::vector<double>& breakpoints01, bool held) {
        return even_times01(level, breakpoints01, held);
      },
      "level"_a, "breakpoints01"_a, "held"_a = false);
  m.def(
      "dense_times01",
      [](Density density, double turns, const std::vector<double>& breakpoints01, bool held) {
        return dense_times01(density, turns, breakpoints01, held);
      },
      "density"_a, "turns"_a, "breakpoints01"_a, "held"_a = false);
  nb::class_<ValueTime>(m, "ValueTime")
      .def_ro("time01", &ValueTime::time01)
      .def_ro("read_at01", &ValueTime::read_at01)
      .def_ro("authored", &ValueTime::authored);
  m.def(
      "value_times",
      [](const std::vector<double>& authored01, const std::vector<double>& switched01) {
        return value_times(authored01, switched01);
      },
      "authored01"_a, "switched01"_a);
}

}  // namespace

void bind_sample(nb::module_& m) {
  m.attr("FINEST_LEVEL") = kFinestLevel;
  m.attr("LARGEST_ELEMENT") = kLargestElement;
  m.attr("MOST_REPEATS") = kMostRepeats;
  m.attr("MOST_TURNS_FOLLOWED") = kMostTurnsFollowed;
  m.attr("BEFORE_JUMP01") = kBeforeJump01;
  nb::class_<PixelSize>(m, "PixelSize")
      .def(
          "__init__",
          [](PixelSize* self, nb::handle camera_box, bool perspective, double per_unit, double near) {
            new (self) PixelSize(pixel_size(camera_box, perspective, per_unit, near));
          },
          "camera_box"_a, "perspective"_a, "per_unit"_a, "near"_a)
      .def_static("uniform", &PixelSize::uniform, "size"_a)
      .def_prop_ro("per_unit", &PixelSize::per_unit)
      .def("at_boxes", &at_boxes, "corners"_a);
  bind_transforms(m);
  bind_turns(m);
  bind_times(m);
  bind_samples(m);
}

}  // namespace msbvh::python
