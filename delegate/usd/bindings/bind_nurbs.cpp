// NURBS patches and the polygons that they are drawn as (delegate/translate/shape/nurbs_*.h).
#include <algorithm>
#include <array>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <tuple>
#include <utility>

#include "delegate/translate/array_samples.h"
#include "delegate/translate/shape/nurbs_grid.h"
#include "delegate/translate/shape/nurbs_patch.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/arrays.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

// Vertex count, order, knots, range.
using AxisArgument = std::tuple<int, int, nb::object, std::optional<std::array<double, 2>>>;

SplineInput axis_from(const char* name, const AxisArgument& given, Borrowed& borrowed) {
  const auto& [count, order, knots, range] = given;
  return {name, count, order, borrowed.doubles(knots, "knots"), range};
}

// (patch or None, diagnostics).
nb::tuple make_patch(const std::string& path, const AxisArgument& u, const AxisArgument& v) {
  Borrowed borrowed;
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, path);
  std::optional<NurbsPatch> patch =
      NurbsPatch::make({path, axis_from("u", u, borrowed), axis_from("v", v, borrowed)}, log);
  return nb::make_tuple(std::move(patch), diagnostics);
}

// What a check says: (whether it passed, diagnostics).
template <typename Check>
nb::tuple checked(const std::string& path, bool optional, const Check& check) {
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, path);
  if (optional) log = log.of_optional_part();
  const bool passed = check(log);
  return nb::make_tuple(passed, diagnostics);
}

std::span<const Vec3f> controls(const NurbsPatch& patch, nb::handle given, Borrowed& borrowed) {
  return elements<Vec3f>(borrowed.keep(checked_array<float>(given, "points", {patch.control_count(), 3})));
}

std::span<const double> weights_from(const NurbsPatch& patch, nb::handle given, Borrowed& borrowed) {
  if (given.is_none()) return {};
  return elements<double>(borrowed.keep(checked_array<double>(given, "weights", {patch.control_count()})));
}

std::vector<std::span<const Vec3f>> poses_from(const NurbsPatch& patch, const nb::list& given,
                                               Borrowed& borrowed) {
  if (given.size() == 0) throw nb::value_error("poses: found none; expected some");
  std::vector<std::span<const Vec3f>> poses;
  for (const nb::handle pose : given) poses.push_back(controls(patch, pose, borrowed));
  return poses;
}

nb::tuple cells_of(const NurbsPatch& patch, const std::string& path, const nb::list& poses,
                   nb::handle weights, nb::handle matrices, const PixelSize& pixel_size, double edge_pixels) {
  Borrowed borrowed;
  const AnyArray array = checked_array<double>(matrices, "matrices", {kAnySize, 4, 4});
  std::vector<Diagnostic> diagnostics;
  PrimLog log(diagnostics, path);
  const std::vector<std::span<const Vec3f>> given = poses_from(patch, poses, borrowed);
  const NurbsCells cells = patch.cells(given, weights_from(patch, weights, borrowed),
                                       elements<Matrix4d>(array), pixel_size, edge_pixels, log);
  return nb::make_tuple(cells.u, cells.v, diagnostics);
}

void check_cells(const std::vector<std::uint32_t>& cells, const SplineAxis& axis, const char* name) {
  const bool fits = cells.size() == axis.spans().size() && std::ranges::none_of(cells, [](std::uint32_t n) {
                      return n == 0 || n > NurbsPatch::kMostSpanCells;
                    });
  if (!fits) throw nb::value_error((std::string(name) + ": expected those of cells()").c_str());
}

NurbsGrid grid_of(const NurbsPatch& patch, const std::vector<std::uint32_t>& u,
                  const std::vector<std::uint32_t>& v, const nb::list& poses, nb::handle weights,
                  bool apart) {
  check_cells(u, patch.u(), "u_cells");
  check_cells(v, patch.v(), "v_cells");
  Borrowed borrowed;
  const std::vector<std::span<const Vec3f>> given = poses_from(patch, poses, borrowed);
  return {patch, {u, v}, given, weights_from(patch, weights, borrowed), apart};
}

// float32[count] or float32[count, 3].
std::pair<std::span<const float>, std::size_t> values_from(nb::handle given, std::size_t count,
                                                           Borrowed& borrowed) {
  const bool vectors = nb::cast<int>(given.attr("ndim")) == 2;
  const AnyArray& array = borrowed.keep(vectors ? checked_array<float>(given, "values", {count, 3})
                                                : checked_array<float>(given, "values", {count}));
  return {elements<float>(array), vectors ? 3 : 1};
}

nb::object values_array(const std::vector<float>& values, std::size_t width) {
  const std::size_t count = values.size() / width;
  return width == 1 ? owned_array<float>(values, {count}) : owned_array<float>(values, {count, width});
}

nb::object positions(const NurbsGrid& grid, nb::handle values, nb::handle weights) {
  Borrowed borrowed;
  const std::span<const Vec3f> points = controls(grid.patch(), values, borrowed);
  const std::span<const float> numbers(&points.front().x, 3 * points.size());
  return values_array(grid.positions(numbers, weights_from(grid.patch(), weights, borrowed)), 3);
}

nb::object vertex_values(const NurbsGrid& grid, nb::handle values, nb::handle weights) {
  Borrowed borrowed;
  const auto [numbers, width] = values_from(values, grid.patch().control_count(), borrowed);
  return values_array(grid.vertex_values(numbers, width, weights_from(grid.patch(), weights, borrowed)),
                      width);
}

nb::object varying_values(const NurbsGrid& grid, nb::handle values) {
  Borrowed borrowed;
  const NurbsPatch& patch = grid.patch();
  const std::size_t count = (patch.u().segment_count() + 1) * (patch.v().segment_count() + 1);
  const auto [numbers, width] = values_from(values, count, borrowed);
  return values_array(grid.varying_values(numbers, width), width);
}

void bind_patch(nb::module_& m) {
  nb::class_<NurbsPatch>(m, "NurbsPatch")
      .def_static("make", &make_patch, "path"_a, "u"_a, "v"_a)
      .def_prop_ro("control_count", &NurbsPatch::control_count)
      .def(
          "check_points",
          [](const NurbsPatch& patch, const std::string& path, double time01, nb::handle points) {
            Borrowed borrowed;
            const ArraySample sample{time01, controls(patch, points, borrowed)};
            return checked(path, false, [&](PrimLog& log) { return check_finite(sample, "points", log); });
          },
          "path"_a, "time01"_a, "points"_a)
      .def(
          "check_weights",
          [](const NurbsPatch& patch, const std::string& path, nb::handle weights) {
            Borrowed borrowed;
            const std::span<const double> given = borrowed.doubles(weights, "weights");
            return checked(path, true, [&](PrimLog& log) { return patch.check_weights(given, log); });
          },
          "path"_a, "weights"_a)
      .def(
          "check_primvar",
          [](const NurbsPatch& patch, const std::string& path, const std::string& attribute,
             const std::string& interpolation, std::size_t value_count, nb::handle indices) {
            Borrowed borrowed;
            const std::span<const int> given = borrowed.ints(indices, "indices");
            return checked(path, true, [&](PrimLog& log) {
              return patch.check_primvar(interpolation, value_count, given, attribute, log);
            });
          },
          "path"_a, "attribute"_a, "interpolation"_a, "value_count"_a, "indices"_a.none())
      .def("cells", &cells_of, "path"_a, "poses"_a, "weights"_a.none(), "matrices"_a, "pixel_size"_a,
           "edge_pixels"_a)
      .def("grid", &grid_of, "u_cells"_a, "v_cells"_a, "poses"_a, "weights"_a.none(), "apart"_a);
}

nb::ndarray<nb::numpy, const int> ints_view(const std::vector<int>& values) {
  return view<int>(values, {values.size()});
}

}  // namespace

void bind_nurbs(nb::module_& m) {
  constexpr auto kInside = nb::rv_policy::reference_internal;
  bind_patch(m);
  nb::class_<NurbsGrid>(m, "NurbsGrid")
      .def_prop_ro(
          "counts", [](const NurbsGrid& grid) { return ints_view(grid.counts()); }, kInside)
      .def_prop_ro(
          "indices", [](const NurbsGrid& grid) { return ints_view(grid.indices()); }, kInside)
      .def_prop_ro(
          "segments", [](const NurbsGrid& grid) { return ints_view(grid.segments()); }, kInside)
      .def("positions", &positions, "values"_a, "weights"_a.none())
      .def("vertex_values", &vertex_values, "values"_a, "weights"_a.none())
      .def("varying_values", &varying_values, "values"_a);
}

}  // namespace msbvh::python
