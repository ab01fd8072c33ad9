// Translator: keyword arguments and numpy arrays to the structs of delegate/translate/inputs.h.
#include <memory>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <tuple>

#include "delegate/translate/translator.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/bindings.h"
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

std::optional<std::vector<VisibleInterval>> visible_from(Arguments& arguments) {
  const nb::object given = arguments.optional("visible");
  if (given.is_none()) return std::nullopt;
  const std::span<const VisibleInterval> all =
      elements<VisibleInterval>(arguments.keep(checked_array<double>(given, "visible", {kAnySize, 2})));
  return std::vector<VisibleInterval>(all.begin(), all.end());
}

RateTimes times_from(Arguments& arguments) {
  RateTimes time_remap;
  time_remap.frame01 = arguments.value_or("frame01", time_remap.frame01, "a float");
  time_remap.seconds_per_shutter =
      arguments.value_or("seconds_per_shutter", time_remap.seconds_per_shutter, "a float");
  time_remap.velocity_scale = arguments.value_or("velocity_scale", time_remap.velocity_scale, "a float");
  return time_remap;
}

TrackChoice choice_from(Arguments& arguments, std::uint32_t max_segments) {
  TrackChoice choice;
  const std::string name = arguments.value_or("interpolation", std::string("auto"), "a str");
  if (name == "linear") choice.max_degree = 1;
  if (name == "quadratic") choice.min_degree = choice.max_degree = 2;
  if (name == "cubic") choice.min_degree = 3;
  if (name != "auto" && name != "linear" && name != "quadratic" && name != "cubic") {
    bad_choice("interpolation", name, "auto, linear, quadratic or cubic");
  }
  choice.segments = arguments.value_or("segments", choice.segments, "an int");
  if (choice.segments != 0 && (!is_valid_segment_count(choice.segments) || choice.segments > max_segments)) {
    throw nb::value_error(("segments: found " + std::to_string(choice.segments) +
                           "; expected a power of two up to " + std::to_string(max_segments))
                              .c_str());
  }
  return choice;
}

// Radius and focus distance at each time; a pinhole where none is given.
std::vector<Lens> lenses_from(Arguments& arguments, std::size_t count) {
  std::vector<Lens> lenses(count);
  const nb::object given = arguments.optional("lenses");
  if (given.is_none()) return lenses;
  const AnyArray array = checked_array<float>(given, "lenses", {count, 2});
  const std::span<const float> values = elements<float>(array);
  for (std::size_t i = 0; i < count; ++i) lenses[i] = {values[2 * i], values[2 * i + 1]};
  return lenses;
}

// Clipping ranges by sample, or none: the camera's stands throughout.
std::vector<std::optional<ClipRange>> clips_from(Arguments& arguments, std::size_t count) {
  std::vector<std::optional<ClipRange>> clips(count);
  const nb::object given = arguments.optional("clips");
  if (given.is_none()) return clips;
  const AnyArray array = checked_array<float>(given, "clips", {count, 2});
  const std::span<const float> values = elements<float>(array);
  for (std::size_t i = 0; i < count; ++i) clips[i] = ClipRange{values[2 * i], values[2 * i + 1]};
  return clips;
}

CameraInput camera_from(Arguments& arguments) {
  CameraInput camera;
  camera.path = arguments.value<std::string>("path", "a str");
  camera.projection = projection_from(arguments.value<std::string>("projection", "a str"));
  camera.near_clip = arguments.value<float>("near_clip", "a float");
  camera.far_clip = arguments.value<float>("far_clip", "a float");
  camera.breakpoints01 = arguments.optional_times("breakpoints01");
  camera.periods01 = arguments.optional_times("periods01").value_or(std::vector<double>{});
  const TransformSamples transform = transform_from(arguments, "times01", "world_from_camera");
  const AnyArray windows =
      checked_array<float>(arguments.required("windows"), "windows", {transform.times01.size(), 4});
  const std::vector<Lens> lenses = lenses_from(arguments, transform.times01.size());
  const std::vector<std::optional<ClipRange>> clips = clips_from(arguments, transform.times01.size());
  for (std::size_t i = 0; i < transform.times01.size(); ++i) {
    const std::span<const float> w = elements<float>(windows).subspan(4 * i, 4);
    camera.samples.push_back(
        {transform.times01[i], transform.matrices[i], {w[0], w[1], w[2], w[3]}, lenses[i], clips[i]});
  }
  return camera;
}

TranslatorSettings settings_from(Arguments& arguments) {
  TranslatorSettings settings;
  settings.width = arguments.value<std::uint32_t>("width", "an int of at least 1");
  settings.height = arguments.value<std::uint32_t>("height", "an int of at least 1");
  if (!arguments.optional("motion_tolerance").is_none()) {
    settings.motion_tolerance_pixels = arguments.value<double>("motion_tolerance", "a float");
  }
  if (!arguments.optional("max_segments").is_none()) {
    settings.max_segments = arguments.value<std::uint32_t>("max_segments", "an int");
  }
  settings.choice = choice_from(arguments, settings.max_segments);
  if (!arguments.optional("keep_faces").is_none())
    settings.keep_faces = arguments.value<bool>("keep_faces", "a bool");
  return settings;
}

// A list of (time, array) in place of the values: samples over the shutter. The one in force at its centre
// stands for the frame's.
template <typename T>
void primvar_samples_from(Arguments& arguments, const char* name, nb::handle list, PrimvarInput<T>& primvar) {
  for (const nb::handle item : list) {
    PrimvarSample<T> sample;
    if (!nb::isinstance<nb::tuple>(item) || nb::len(item) != 2 || !nb::try_cast(item[0], sample.time01)) {
      arguments.fail(name, item, "(time, array) for each sample");
    }
    const std::string part = std::string(name) + "[1][" + std::to_string(primvar.samples.size()) + "][1]";
    sample.values = arguments.floats<T>(item[1], part);
    if (primvar.samples.empty() || sample.time01 <= 0.5) primvar.values = sample.values;
    primvar.samples.push_back(sample);
  }
}

// (interpolation, values or samples, indices or None), or None.
template <typename T>
PrimvarInput<T> primvar_from(Arguments& arguments, const char* name) {
  PrimvarInput<T> primvar;
  const nb::object given = arguments.optional(name);
  if (given.is_none()) return primvar;
  if (!nb::isinstance<nb::tuple>(given) || nb::len(given) != 3 ||
      !nb::try_cast(given[0], primvar.interpolation)) {
    arguments.fail(name, given, "(interpolation, values, indices or None)");
  }
  if (nb::isinstance<nb::list>(given[1])) {
    primvar_samples_from(arguments, name, given[1], primvar);
  } else {
    primvar.values = arguments.floats<T>(given[1], std::string(name) + "[1]");
  }
  if (!nb::object(given[2]).is_none()) {
    primvar.indices =
        elements<int>(arguments.keep(checked_array<int>(given[2], std::string(name) + "[2]", {kAnySize})));
  }
  return primvar;
}

MeshInput mesh_from(Arguments& arguments) {
  MeshInput mesh;
  mesh.path = arguments.value<std::string>("path", "a str");
  arguments.required("face_vertex_counts");
  arguments.required("face_vertex_indices");
  mesh.face_vertex_counts = arguments.ints("face_vertex_counts");
  mesh.face_vertex_indices = arguments.ints("face_vertex_indices");
  mesh.hole_indices = arguments.ints("hole_indices");
  mesh.left_handed = arguments.value<bool>("left_handed", "a bool");
  arguments.required("points");
  const bool held = arguments.value<bool>("points_held", "a bool");
  mesh.points = arguments.samples("points", held);
  mesh.rates = {arguments.samples("velocities", held), arguments.samples("accelerations", held)};
  mesh.time_remap = times_from(arguments);
  mesh.topology_varies = arguments.value_or("topology_varies", false, "a bool");
  mesh.computed_points = arguments.value_or("computed_points", false, "a bool");
  mesh.visible = visible_from(arguments);
  mesh.world_from_object = transform_from(arguments, "transform_times01", "transforms");
  mesh.world_from_object.breakpoints01 = arguments.optional_times("transform_breakpoints01");
  mesh.world_from_object.periods01 =
      arguments.optional_times("transform_periods01").value_or(std::vector<double>{});
  mesh.world_from_object.held = arguments.value_or("transforms_held", false, "a bool");
  mesh.world_from_object.error_pixels = arguments.value_or("transform_error_pixels", 0.0, "a float");
  mesh.normals = arguments.samples("normals", held);
  mesh.normals_interpolation = arguments.value<std::string>("normals_interpolation", "a str");
  mesh.normals_indices = arguments.ints("normals_indices");
  mesh.computed_normals = computed_normals_from(arguments.value<std::string>("computed_normals", "a str"));
  mesh.display_color = primvar_from<Vec3f>(arguments, "display_color");
  mesh.display_opacity = primvar_from<float>(arguments, "display_opacity");
  if (!arguments.optional("material").is_none()) {
    mesh.material = arguments.value<std::uint32_t>("material", "an int or None");
  }
  mesh.face_materials = arguments.ints("face_materials");
  arguments.expect_no_more();
  return mesh;
}

void add_mesh(Translator& translator, const nb::kwargs& keywords) {
  Arguments arguments(keywords, "add_mesh");
  const MeshInput mesh = mesh_from(arguments);
  nb::gil_scoped_release release;
  translator.add_mesh(mesh);
}

void add_prototype_mesh(Translator& translator, std::uint32_t prototype, const nb::kwargs& keywords) {
  Arguments arguments(keywords, "add_prototype_mesh");
  const MeshInput mesh = mesh_from(arguments);
  nb::gil_scoped_release release;
  translator.add_prototype_mesh(prototype, mesh);
}

// One level of instancing from a dict, with what it borrows.
class LevelArguments {
 public:
  LevelArguments(nb::handle dict, const char* function)
      : keywords_(nb::borrow<nb::kwargs>(dict)), arguments_(keywords_, function) {
    const bool held = arguments_.value_or("held", false, "a bool");
    if (arguments_.optional("selected").is_none()) {
      read_matrices(held);
    } else {
      read_points(held);
    }
    arguments_.expect_no_more();
  }
  LevelArguments(const LevelArguments&) = delete;

  InstanceLevel level() const {
    InstanceLevel level = level_;
    if (has_points_) level.points = &points_;
    return level;
  }

 private:
  void read_matrices(bool held) {
    const std::span<const double> times01 = arguments_.times("times01");
    level_.times01.assign(times01.begin(), times01.end());
    level_.matrices = elements<Matrix4d>(arguments_.keep(checked_array<double>(
        arguments_.required("matrices"), "matrices", {times01.size(), kAnySize, 4, 4})));
    level_.breakpoints01 = arguments_.optional_times("breakpoints01");
    level_.periods01 = arguments_.optional_times("periods01").value_or(std::vector<double>{});
    level_.held = held;
  }
  void read_points(bool held) {
    has_points_ = true;
    level_.selected = arguments_.ints("selected");
    points_.path = arguments_.value_or("path", points_.path, "a str");
    points_.count = arguments_.value<std::uint64_t>("count", "an int");
    points_.positions = arguments_.samples("positions", held);
    points_.scales = arguments_.samples("scales", held);
    points_.orientations = arguments_.quaternions("orientations", held);
    points_.orientations_name = arguments_.value_or("orientations_name", points_.orientations_name, "a str");
    points_.rates = {arguments_.samples("velocities", held), arguments_.samples("accelerations", held)};
    points_.angular_velocities = arguments_.samples("angular_velocities", held);
    points_.time_remap = times_from(arguments_);
  }

  nb::kwargs keywords_;
  Arguments arguments_;
  InstanceLevel level_;
  PointInstancerInput points_;
  bool has_points_ = false;
};

using Levels = std::vector<std::unique_ptr<LevelArguments>>;

Levels levels_from(Arguments& arguments, const char* function, InstancesInput& input) {
  const nb::object list = arguments.required("levels");
  if (!nb::isinstance<nb::sequence>(list)) arguments.fail("levels", list, "a list of dicts");
  Levels levels;
  for (const nb::handle item : list) {
    if (!nb::isinstance<nb::dict>(item)) arguments.fail("levels", item, "a dict for each level");
    levels.push_back(std::make_unique<LevelArguments>(item, function));
    input.levels.push_back(levels.back()->level());
  }
  return levels;
}

void add_instances(Translator& translator, const nb::kwargs& keywords) {
  Arguments arguments(keywords, "add_instances");
  InstancesInput input;
  input.path = arguments.value<std::string>("path", "a str");
  input.prototype = arguments.value<std::uint32_t>("prototype", "an int");
  const Levels levels = levels_from(arguments, "add_instances", input);
  input.visible = visible_from(arguments);
  const nb::object colors = arguments.optional("display_color");
  if (nb::isinstance<nb::list>(colors)) {
    primvar_samples_from(arguments, "display_color", colors, input.display_color);
  } else if (!colors.is_none()) {
    input.display_color.values = arguments.floats<Vec3f>(colors, "display_color");
  }
  input.materials = arguments.ints("materials");
  input.paths = arguments.value_or("paths", std::vector<std::string>{}, "a list of str");
  input.report_whole = arguments.value_or("report_whole", false, "a bool");
  arguments.expect_no_more();
  nb::gil_scoped_release release;
  translator.add_instances(input);
}

double pixels_per_unit(const Translator& translator, const nb::kwargs& keywords) {
  Arguments arguments(keywords, "pixels_per_unit");
  InstancesInput input;
  const Levels levels = levels_from(arguments, "pixels_per_unit", input);
  const AnyArray box = checked_array<double>(arguments.required("box"), "box", {2, 3});
  arguments.expect_no_more();
  const std::span<const Vec3d> ends = elements<Vec3d>(box);
  const Box3d bounds{ends[0], ends[1]};
  nb::gil_scoped_release release;
  return translator.pixels_per_unit(input, bounds);
}

std::uint32_t add_material(Translator& translator, const nb::kwargs& keywords) {
  using Rgb = std::tuple<float, float, float>;
  Arguments arguments(keywords, "add_material");
  Material material;
  material.name = arguments.value<std::string>("name", "a str");
  material.diffuse_color = color_from(arguments.value<Rgb>("diffuse_color", "(r, g, b)"));
  material.diffuse_from_display_color = arguments.value<bool>("diffuse_from_display_color", "a bool");
  material.emissive_color = color_from(arguments.value<Rgb>("emissive_color", "(r, g, b)"));
  material.emissive_from_display_color = arguments.value<bool>("emissive_from_display_color", "a bool");
  material.opacity = arguments.value<float>("opacity", "a float");
  material.opacity_from_display_opacity = arguments.value<bool>("opacity_from_display_opacity", "a bool");
  material.opacity_threshold = arguments.value<float>("opacity_threshold", "a float");
  arguments.expect_no_more();
  return translator.add_material(material);
}

// Radiance and sizes (angle in degrees, radius, width, height) at times; none: still.
void add_light_samples(Arguments& arguments, LightInput& input) {
  if (arguments.optional("values_times01").is_none()) return;
  const std::span<const double> times01 = arguments.times("values_times01");
  const AnyArray radiances =
      checked_array<float>(arguments.required("radiances"), "radiances", {times01.size(), 3});
  const AnyArray sizes = checked_array<float>(arguments.required("sizes"), "sizes", {times01.size(), 4});
  input.values_times01.assign(times01.begin(), times01.end());
  for (std::size_t i = 0; i < times01.size(); ++i) {
    const std::span<const float> size = elements<float>(sizes).subspan(4 * i, 4);
    input.values.push_back({elements<Vec3f>(radiances)[i], size[0], size[1], size[2], size[3]});
  }
}

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
  input.world_from_light = transform_from(arguments, "times01", "world_from_light");
  add_light_samples(arguments, input);
  arguments.expect_no_more();
  translator.add_light(input);
}

void bind_reports(nb::module_& m) {
  nb::class_<Diagnostic>(m, "Diagnostic")
      .def_prop_ro("severity",
                   [](const Diagnostic& d) { return d.severity == Severity::kError ? "error" : "warning"; })
      .def_ro("path", &Diagnostic::path)
      .def_ro("attribute", &Diagnostic::attribute)
      .def_ro("message", &Diagnostic::message);
  nb::class_<TrackReport>(m, "TrackReport")
      .def_ro("path", &TrackReport::path)
      .def_ro("source", &TrackReport::source)
      .def_ro("rule", &TrackReport::rule)
      .def_ro("segments", &TrackReport::segments)
      .def_ro("degree", &TrackReport::degree)
      .def_ro("time_remap", &TrackReport::time_remap)
      .def_ro("hidden_partly", &TrackReport::hidden_partly)
      .def_ro("bytes", &TrackReport::bytes)
      .def_ro("count", &TrackReport::count)
      .def_ro("moving_transform", &TrackReport::moving_transform)
      .def_ro("error_pixels", &TrackReport::error_pixels);
}

}  // namespace

void bind_translator(nb::module_& m) {
  bind_reports(m);
  nb::class_<Translator>(m, "Translator")
      .def("__init__",
           [](Translator* self, const nb::kwargs& keywords) {
             Arguments arguments(keywords, "Translator");
             const CameraInput camera = camera_from(arguments);
             const TranslatorSettings settings = settings_from(arguments);
             arguments.expect_no_more();
             new (self) Translator(camera, settings);
           })
      .def("add_mesh", &add_mesh)
      .def("begin_prototype", &Translator::begin_prototype, nb::arg("path"), nb::arg("pixels_per_unit") = 0.0)
      .def("pixels_per_unit", &pixels_per_unit)
      .def("add_prototype_mesh", &add_prototype_mesh, nb::arg("prototype"), nb::arg("mesh"))
      .def("add_instances", &add_instances)
      .def("add_material", &add_material)
      .def("add_light", &add_light)
      .def_prop_ro("empty", &Translator::empty)
      .def_prop_ro("empty_meshes", &Translator::empty_meshes)
      .def("diagnostics", &Translator::diagnostics, nb::rv_policy::copy)
      .def("tracks", &Translator::tracks, nb::rv_policy::copy)
      .def("finish", [](Translator& translator) {
        const Vec3d origin = translator.origin();
        return SceneHandle{translator.finish(), origin};
      });
}

}  // namespace msbvh::python
