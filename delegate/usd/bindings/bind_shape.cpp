// What implicit shapes and subsets are (delegate/translate/shape).
#include <algorithm>
#include <cstdint>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "delegate/translate/shape/crowd.h"
#include "delegate/translate/shape/implicit_shape.h"
#include "delegate/translate/shape/sides.h"
#include "delegate/translate/shape/subsets.h"
#include "delegate/translate/tessellation.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/arrays.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/choices.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

using Values = std::vector<double>;

constexpr int kFewestSides = 4;

ImplicitKind kind_from(const std::string& name) {
  if (const std::optional<ImplicitKind> kind = implicit_kind(name)) return *kind;
  std::string names;
  for (const ImplicitType& type : implicit_types()) {
    names += (names.empty() ? "" : ", ") + std::string(type.name);
  }
  bad_choice("kind", name, names.c_str());
}

Axis axis_named(const std::string& name) {
  if (const std::optional<Axis> axis = axis_from(name)) return *axis;
  bad_choice("axis", name, "X, Y or Z");
}

void check_count(ImplicitKind kind, const Values& values) {
  if (values.size() != implicit_type(kind).parameters.size()) {
    throw nb::value_error("values: expected one for each of the type's parameters");
  }
}

void check_sides(ImplicitKind kind, int sides) {
  if (implicit_type(kind).smooth && sides < kFewestSides) throw nb::value_error("sides: expected at least 4");
}

// (name, parameters, smooth) of each type.
nb::list types() {
  nb::list all;
  for (const ImplicitType& type : implicit_types()) {
    nb::list parameters;
    for (const std::string_view name : type.parameters) parameters.append(std::string(name));
    all.append(nb::make_tuple(std::string(type.name), nb::tuple(parameters), type.smooth));
  }
  return all;
}

Surface surface_along_z(const std::string& kind_name, const Values& values, int sides) {
  const ImplicitKind kind = kind_from(kind_name);
  check_count(kind, values);
  check_sides(kind, sides);
  return implicit_surface(kind, values, Axis::kZ, sides);
}

// (shape or None, diagnostics).
nb::tuple make_shape(const std::string& path, const std::string& kind_name, const std::string& axis,
                     const std::vector<Values>& values) {
  const ImplicitKind kind = kind_from(kind_name);
  for (const Values& each : values) check_count(kind, each);
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, path);
  std::optional<ImplicitShape> shape = ImplicitShape::make({path, kind, axis, values}, log);
  return nb::make_tuple(std::move(shape), diagnostics);
}

Surface surface_at(const ImplicitShape& shape, std::size_t time, int sides) {
  check_sides(shape.kind(), sides);
  if (time >= shape.time_count()) throw nb::index_error("time: expected the number of one of the times");
  return shape.surface(time, sides);
}

nb::object box_of(const ImplicitShape& shape, int sides) {
  check_sides(shape.kind(), sides);
  const Box3d box = shape.box(sides);
  return owned_array<double>(std::vector<Vec3d>{box.lo, box.hi}, {2, 3});
}

void bind_surfaces(nb::module_& m) {
  constexpr auto kInside = nb::rv_policy::reference_internal;
  nb::class_<Surface>(m, "Surface")
      .def_prop_ro(
          "counts", [](const Surface& s) { return view<int>(s.counts, {s.counts.size()}); }, kInside)
      .def_prop_ro(
          "indices", [](const Surface& s) { return view<int>(s.indices, {s.indices.size()}); }, kInside)
      .def_prop_ro(
          "points",
          [](const Surface& s) {
            return view<double>(s.points, {s.points.size(), 3});
          },
          kInside);
  m.def("implicit_types", &types);
  m.def("implicit_surface", &surface_along_z, "kind"_a, "values"_a, "sides"_a);
  nb::class_<ImplicitShape>(m, "ImplicitShape")
      .def_static("make", &make_shape, "path"_a, "kind"_a, "axis"_a, "values"_a)
      .def_prop_ro("radius", &ImplicitShape::radius)
      .def("box", &box_of, "sides"_a)
      .def("surface", &surface_at, "time"_a, "sides"_a);
}

nb::object sides_of_radii(nb::handle radii_pixels, double silhouette_pixels, const std::vector<int>& counts) {
  const AnyArray radii = checked_array<double>(radii_pixels, "radii_pixels", {kAnySize});
  if (counts.empty()) throw nb::value_error("side_counts: found none; expected some");
  return owned_array<int>(sides_for(elements<double>(radii), silhouette_pixels, counts), {radii.shape(0)});
}

double stray_of_shape(const std::string& kind_name, int sides) {
  const ImplicitKind kind = kind_from(kind_name);
  check_sides(kind, sides);
  return stray_of(kind, sides);
}

nb::object radii(const std::string& kind, double radius, nb::handle box, nb::handle matrices,
                 const PixelSize& pixel_size) {
  const AnyArray ends = checked_array<double>(box, "box", {2, 3});
  const AnyArray array = checked_array<double>(matrices, "matrices", {kAnySize, kAnySize, 4, 4});
  const std::span<const Vec3d> corners = elements<Vec3d>(ends);
  const std::size_t count = array.shape(1);
  return owned_array<double>(radii_in_pixels(kind_from(kind), radius, {corners[0], corners[1]},
                                             elements<Matrix4d>(array), count, pixel_size),
                             {count});
}

void bind_sides(nb::module_& m) {
  nb::list counts;
  for (const int sides : kSideCounts) counts.append(sides);
  m.attr("SIDE_COUNTS") = nb::tuple(counts);
  m.attr("SIDES") = kUnmeasuredSides;
  nb::dict silhouettes;
  for (const Silhouette& silhouette : kSilhouettes) {
    silhouettes[nb::cast(std::string(silhouette.complexity))] = silhouette.pixels;
  }
  m.attr("SILHOUETTES") = silhouettes;
  nb::dict edges;
  for (const ComplexityEdge& edge : kComplexityEdges)
    edges[nb::cast(std::string(edge.complexity))] = edge.pixels;
  m.attr("EDGE_LENGTHS") = edges;
  m.def("sides_for", &sides_of_radii, "radii_pixels"_a, "silhouette_pixels"_a, "side_counts"_a);
  m.def("stray_of", &stray_of_shape, "kind"_a, "sides"_a);
  m.def("radii_in_pixels", &radii, "kind"_a, "radius"_a, "box"_a, "matrices"_a, "pixel_size"_a);
}

std::optional<UnitForm> unit_form_of(const std::string& kind_name, const Values& values,
                                     const std::string& axis) {
  const ImplicitKind kind = kind_from(kind_name);
  check_count(kind, values);
  return unit_form(kind, values, axis_named(axis));
}

nb::object shapes_from_units(const std::vector<const UnitForm*>& forms) {
  std::vector<Matrix4d> matrices;
  matrices.reserve(forms.size());
  for (const UnitForm* form : forms) matrices.push_back(shape_from_unit(*form));
  return owned_array<double>(matrices, {matrices.size(), 4, 4});
}

nb::object instances_possible(nb::handle matrices, nb::handle colors, std::optional<float> opacity) {
  const AnyArray array = checked_array<double>(matrices, "matrices", {kAnySize, kAnySize, 4, 4});
  const std::size_t count = array.shape(1);
  Borrowed borrowed;
  std::span<const Vec3f> given;
  if (!colors.is_none()) {
    given = elements<Vec3f>(borrowed.keep(checked_array<float>(colors, "colors", {count, 3})));
  }
  return owned_array<bool>(can_be_instances(elements<Matrix4d>(array), count, given, opacity), {count});
}

void bind_crowds(nb::module_& m) {
  m.attr("SHARED_FROM") = kSharedFrom;
  m.attr("MOST_PLACES") = kMostPlaces;
  nb::class_<UnitForm>(m, "UnitForm").def_prop_ro("parameters", [](const UnitForm& form) {
    return nb::tuple(nb::cast(form.parameters));
  });
  m.def("unit_form", &unit_form_of, "kind"_a, "values"_a, "axis"_a);
  m.def("shapes_from_units", &shapes_from_units, "forms"_a);
  m.def("can_be_instances", &instances_possible, "matrices"_a, "colors"_a.none(), "opacity"_a.none());
}

// (int32 owners, diagnostics) of subsets, each (path, int32 indices).
nb::tuple owners_of_faces(const std::vector<std::pair<std::string, nb::object>>& given,
                          std::size_t face_count) {
  Borrowed borrowed;
  std::vector<FaceSubset> subsets;
  for (const auto& [path, indices] : given) subsets.push_back({path, borrowed.ints(indices, "indices")});
  std::vector<Diagnostic> diagnostics;
  const std::vector<int> owners = face_owners(subsets, face_count, diagnostics);
  return nb::make_tuple(owned_array<int>(owners, {face_count}), diagnostics);
}

nb::object materials_of_faces(nb::handle owners, const std::vector<std::optional<int>>& of_subsets,
                              std::optional<int> own) {
  const AnyArray array = checked_array<int>(owners, "owners", {kAnySize});
  const std::span<const int> numbers = elements<int>(array);
  if (!numbers.empty() && std::ranges::max(numbers) >= std::int64_t(of_subsets.size())) {
    throw nb::value_error("owners: expected numbers of subsets");
  }
  std::vector<int> materials;
  for (const std::optional<int> material : of_subsets) materials.push_back(material.value_or(-1));
  return owned_array<int>(face_materials(numbers, materials, own.value_or(-1)), {numbers.size()});
}

void bind_subsets(nb::module_& m) {
  m.def("binds_faces", &binds_faces, "element_type"_a, "family_name"_a);
  m.def("face_owners", &owners_of_faces, "subsets"_a, "face_count"_a);
  m.def("face_materials", &materials_of_faces, "owners"_a, "of_subsets"_a, "own"_a.none());
}

}  // namespace

void bind_shape(nb::module_& m) {
  bind_surfaces(m);
  bind_sides(m);
  bind_crowds(m);
  bind_subsets(m);
}

}  // namespace msbvh::python
