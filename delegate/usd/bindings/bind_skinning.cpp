// Skinning: keyword arguments and numpy arrays to the structs of delegate/translate/skinning.h, and a Python
// object as translate::PoseSource.
#include <algorithm>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "delegate/translate/sample/pose_sampler.h"
#include "delegate/translate/skinning.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/python_motion.h"

namespace nb = nanobind;
using namespace nb::literals;

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

void read_influences(Arguments& arguments, SkinningInput& input) {
  input.method = method_from(arguments.value<std::string>("method", "a str"));
  input.joint_indices = arguments.ints("joint_indices");
  const nb::object weights = arguments.optional("joint_weights");
  if (!weights.is_none()) input.joint_weights = arguments.borrowed().scalars(weights, "joint_weights");
  input.influences_per_point = arguments.value<int>("influences_per_point", "an int");
  input.constant_influences = arguments.value<bool>("constant_influences", "a bool");
  const AnyArray bind = checked_array<double>(arguments.required("geom_bind"), "geom_bind", {4, 4});
  input.geom_bind = elements<Matrix4d>(bind).front();
}

void read_sub_shapes(Arguments& arguments, SkinningInput& input) {
  const nb::object shapes = arguments.required("sub_shapes");
  if (!nb::isinstance<nb::sequence>(shapes)) arguments.fail("sub_shapes", shapes, "a list of tuples");
  for (const nb::handle item : shapes) {
    const std::string name = "sub_shapes[" + std::to_string(input.sub_shapes.size()) + "]";
    input.sub_shapes.push_back(sub_shape_from(arguments, item, name));
  }
}

// All that no time changes.
SkinningInput mesh_from(Arguments& arguments) {
  SkinningInput input;
  input.path = arguments.value<std::string>("path", "a str");
  input.points = arguments.borrowed().vectors(arguments.required("points"), "points");
  const nb::object normals = arguments.optional("normals");
  if (!normals.is_none()) input.normals = arguments.borrowed().vectors(normals, "normals");
  input.normal_points = arguments.ints("normal_points");
  read_influences(arguments, input);
  read_sub_shapes(arguments, input);
  return input;
}

void read_poses(Arguments& arguments, SkinningInput& input) {
  const std::span<const double> times01 = arguments.times("times01");
  input.times01.assign(times01.begin(), times01.end());
  const nb::object joints = arguments.optional("joints");
  if (!joints.is_none()) {
    const AnyArray& array =
        arguments.keep(checked_array<double>(joints, "joints", {input.times01.size(), kAnySize, 4, 4}));
    input.joint_count = array.shape(1);
    input.joints = elements<Matrix4d>(array);
  }
  const nb::object weights = arguments.optional("sub_shape_weights");
  if (weights.is_none()) return;
  input.sub_shape_weights = elements<float>(arguments.keep(
      checked_array<float>(weights, "sub_shape_weights", {input.times01.size(), input.sub_shapes.size()})));
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
  SkinningInput input = mesh_from(arguments);
  read_poses(arguments, input);
  arguments.expect_no_more();
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

// A Python object with the same members. evaluate() gives None, or joints float64[T, J, 4, 4], weights
// float32[T, S] and rest points float32[N, 3], each of which may be None.
class PythonPoses : public PoseSource {
 public:
  explicit PythonPoses(nb::handle poses) : poses_(poses) {}

  bool still() const override { return get<bool>("still"); }
  std::vector<double> breakpoints01() const override { return get<std::vector<double>>("breakpoints01"); }
  Turns turns() const override {
    const nb::gil_scoped_acquire gil;
    return nb::cast<Turns>(poses_.attr("turns")());
  }
  bool moves_rest() const override { return get<bool>("moves_rest"); }
  bool evaluate(std::span<const double> times01, PoseValues& out) const override {
    const nb::gil_scoped_acquire gil;
    const nb::object found = poses_.attr("evaluate")(std::vector<double>(times01.begin(), times01.end()));
    if (found.is_none()) return false;
    if (!nb::isinstance<nb::tuple>(found) || nb::len(found) != 3)
      wrong_type("evaluate()", found, "(joints, weights, rest points) or None");
    const std::size_t times = times01.size();
    fill<double>(out.joints, found[0], "evaluate()[0]", {times, kAnySize, 4, 4});
    fill<float>(out.weights, found[1], "evaluate()[1]", {times, kAnySize});
    fill<float>(out.rest, found[2], "evaluate()[2]", {kAnySize, 3});
    return true;
  }

 private:
  template <typename T>
  T get(const char* name) const {
    const nb::gil_scoped_acquire gil;
    return nb::cast<T>(poses_.attr(name));
  }

  template <typename Scalar, typename Element>
  static void fill(std::vector<Element>& out, nb::handle values, const char* name,
                   std::initializer_list<std::size_t> shape) {
    if (values.is_none()) return;
    const AnyArray array = checked_array<Scalar>(values, name, shape);
    const std::span<const Element> all = elements<Element>(array);
    out.assign(all.begin(), all.end());
  }

  nb::handle poses_;
};

// With the arrays that the mesh borrows.
class PoseSamplerObject {
 public:
  explicit PoseSamplerObject(const nb::kwargs& keywords)
      : keywords_(keywords),
        arguments_(keywords_, "PoseSampler"),
        mesh_(mesh_from(arguments_)),
        sampler_(mesh_) {
    arguments_.expect_no_more();
  }
  PoseSamplerObject(const PoseSamplerObject&) = delete;
  PoseSamplerObject& operator=(const PoseSamplerObject&) = delete;

  // (what was sampled or None, diagnostics).
  nb::tuple sample(nb::handle poses, nb::handle placed, const PixelSize& pixel_size, double tolerance_pixels,
                   bool held) {
    std::vector<Diagnostic> diagnostics;
    std::optional<PoseSamples> samples;
    {
      nb::gil_scoped_release release;
      PrimLog log(diagnostics, mesh_.path);
      samples =
          sampler_.sample(PythonPoses(poses), PythonMotion(placed), pixel_size, tolerance_pixels, held, log);
    }
    if (!samples) return nb::make_tuple(nb::none(), diagnostics);
    return nb::make_tuple(std::move(*samples), diagnostics);
  }

 private:
  nb::kwargs keywords_;
  Arguments arguments_;
  SkinningInput mesh_;
  PoseSampler sampler_;
};

// float32[N, 3] that lives as long as Python wants it, read-only.
nb::object shared_array(const PosedArray& values) {
  const nb::capsule owner(new PosedArray(values),
                          [](void* p) noexcept { delete static_cast<PosedArray*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, const float>(values->data(), {values->size(), 3}, owner));
}

// (time01, array) of each pose that has such an array.
nb::list pairs(const PoseSamples& samples, PosedArray Pose::*array) {
  nb::list pairs;
  for (std::size_t i = 0; i < samples.poses.size(); ++i) {
    const PosedArray& values = samples.poses[i].*array;
    if (values) pairs.append(nb::make_tuple(samples.times01[i], shared_array(values)));
  }
  return pairs;
}

void bind_pose_sampler(nb::module_& m) {
  nb::class_<PoseSamples>(m, "PoseSamples")
      .def_prop_ro("points", [](const PoseSamples& samples) { return pairs(samples, &Pose::points); })
      .def_prop_ro("normals", [](const PoseSamples& samples) { return pairs(samples, &Pose::normals); })
      .def_ro("held", &PoseSamples::held)
      .def_ro("follows", &PoseSamples::follows);
  nb::class_<PoseSamplerObject>(m, "PoseSampler")
      .def("__init__", [](PoseSamplerObject* self,
                          const nb::kwargs& keywords) { new (self) PoseSamplerObject(keywords); })
      .def("sample", &PoseSamplerObject::sample, "poses"_a, "placed"_a, "pixel_size"_a, "tolerance_pixels"_a,
           "held"_a);
}

}  // namespace

void bind_skinning(nb::module_& m) {
  m.def("skin_points", &skin);
  bind_pose_sampler(m);
}

}  // namespace msbvh::python
