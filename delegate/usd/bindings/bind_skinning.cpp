// skin_points: keyword arguments and numpy arrays to the structs of delegate/translate/skinning.h.
#include <algorithm>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "delegate/translate/skinning.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/bindings.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

SkinningMethod method_from(const std::string& name) {
  if (name == "classicLinear") return SkinningMethod::kLinear;
  if (name == "dualQuaternion") return SkinningMethod::kDualQuaternion;
  throw nb::value_error(("method: found \"" + name + "\"; expected classicLinear or dualQuaternion").c_str());
}

// (path, offsets or None, normal offsets or None, point indices or None).
SubShape sub_shape_from(Arguments& arguments, nb::handle item, const std::string& name) {
  constexpr const char* kExpected = "(path, offsets, normal offsets, point indices)";
  SubShape shape;
  if (!nb::isinstance<nb::tuple>(item) || nb::len(item) != 4 || !nb::try_cast(item[0], shape.path)) {
    arguments.fail("sub_shapes", item, kExpected);
  }
  if (!nb::object(item[1]).is_none()) shape.offsets = arguments.borrowed().vectors(item[1], name + "[1]");
  if (!nb::object(item[2]).is_none())
    shape.normal_offsets = arguments.borrowed().vectors(item[2], name + "[2]");
  if (!nb::object(item[3]).is_none()) {
    shape.point_indices =
        elements<int>(arguments.keep(checked_array<int>(item[3], name + "[3]", {kAnySize})));
  }
  return shape;
}

void read_joints(Arguments& arguments, SkinningInput& input) {
  input.joint_indices = arguments.ints("joint_indices");
  const nb::object weights = arguments.optional("joint_weights");
  if (!weights.is_none()) input.joint_weights = arguments.borrowed().scalars(weights, "joint_weights");
  input.influences_per_point = arguments.value<int>("influences_per_point", "an int");
  input.constant_influences = arguments.value<bool>("constant_influences", "a bool");
  const AnyArray bind = checked_array<double>(arguments.required("geom_bind"), "geom_bind", {4, 4});
  input.geom_bind = elements<Matrix4d>(bind).front();
  const nb::object joints = arguments.optional("joints");
  if (joints.is_none()) return;
  const AnyArray& array =
      arguments.keep(checked_array<double>(joints, "joints", {input.times01.size(), kAnySize, 4, 4}));
  input.joint_count = array.shape(1);
  input.joints = elements<Matrix4d>(array);
}

void read_sub_shapes(Arguments& arguments, SkinningInput& input) {
  const nb::object shapes = arguments.required("sub_shapes");
  if (!nb::isinstance<nb::sequence>(shapes)) arguments.fail("sub_shapes", shapes, "a list of tuples");
  for (const nb::handle item : shapes) {
    const std::string name = "sub_shapes[" + std::to_string(input.sub_shapes.size()) + "]";
    input.sub_shapes.push_back(sub_shape_from(arguments, item, name));
  }
  const nb::object weights = arguments.optional("sub_shape_weights");
  if (weights.is_none()) return;
  input.sub_shape_weights = elements<float>(arguments.keep(
      checked_array<float>(weights, "sub_shape_weights", {input.times01.size(), input.sub_shapes.size()})));
}

SkinningInput skinning_from(Arguments& arguments) {
  SkinningInput input;
  input.path = arguments.value<std::string>("path", "a str");
  const std::span<const double> times01 = arguments.times("times01");
  input.times01.assign(times01.begin(), times01.end());
  input.points = arguments.borrowed().vectors(arguments.required("points"), "points");
  const nb::object normals = arguments.optional("normals");
  if (!normals.is_none()) input.normals = arguments.borrowed().vectors(normals, "normals");
  input.normal_points = arguments.ints("normal_points");
  input.method = method_from(arguments.value<std::string>("method", "a str"));
  read_joints(arguments, input);
  read_sub_shapes(arguments, input);
  arguments.expect_no_more();
  return input;
}

// float32[T, N, 3], owned by Python.
nb::object stacked(const std::vector<std::vector<Vec3f>>& arrays) {
  if (arrays.empty()) return nb::none();
  const std::size_t count = arrays.front().size();
  Vec3f* data = new Vec3f[std::max<std::size_t>(arrays.size() * count, 1)];
  const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<Vec3f*>(p); });
  for (std::size_t t = 0; t < arrays.size(); ++t) std::ranges::copy(arrays[t], data + t * count);
  return nb::cast(nb::ndarray<nb::numpy, float>(data, {arrays.size(), count, 3}, owner));
}

nb::tuple skin(const nb::kwargs& keywords) {
  Arguments arguments(keywords, "skin_points");
  const SkinningInput input = skinning_from(arguments);
  std::vector<Diagnostic> diagnostics;
  std::optional<SkinnedArrays> skinned;
  {
    nb::gil_scoped_release release;
    PrimLog log(diagnostics, input.path);
    skinned = skin_points(input, log);
  }
  if (!skinned) return nb::make_tuple(nb::none(), nb::none(), diagnostics);
  return nb::make_tuple(stacked(skinned->points), stacked(skinned->normals), diagnostics);
}

}  // namespace

void bind_skinning(nb::module_& m) { m.def("skin_points", &skin); }

}  // namespace msbvh::python
