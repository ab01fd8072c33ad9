// Translator: keyword arguments and numpy arrays to the structs of delegate/translate/inputs.h.
#include <deque>
#include <memory>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unordered_map.h>
#include <nanobind/stl/vector.h>
#include <tuple>
#include <utility>

#include "delegate/translate/translator.h"
#include "delegate/usd/bindings/arguments.h"
#include "delegate/usd/bindings/bindings.h"
#include "delegate/usd/bindings/choices.h"
#include "delegate/usd/bindings/level_object.h"
#include "delegate/usd/bindings/light_arguments.h"
#include "delegate/usd/bindings/mesh_object.h"

namespace nb = nanobind;

namespace msbvh::python {
namespace {

using namespace msbvh::translate;

TransformSamples transform_from(Arguments& arguments, const char* times, const char* matrices) {
  const std::span<const double> times01 = arguments.times(times);
  return {{times01.begin(), times01.end()}, arguments.matrices(matrices, times01.size()), std::nullopt};
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

// float32[P, 4]: normals and offsets.
std::vector<ClippingPlane> planes_from(Arguments& arguments) {
  std::vector<ClippingPlane> planes;
  const nb::object given = arguments.optional("clipping_planes");
  if (given.is_none()) return planes;
  const AnyArray array = checked_array<float>(given, "clipping_planes", {kAnySize, 4});
  const std::span<const float> values = elements<float>(array);
  for (std::size_t i = 0; i + 3 < values.size(); i += 4)
    planes.push_back({{values[i], values[i + 1], values[i + 2]}, values[i + 3]});
  return planes;
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
  camera.clipping_planes = planes_from(arguments);
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

Displaced displaced_from(Arguments& arguments) {
  const std::string name = arguments.value_or("displacement", std::string("auto"), "a str");
  if (name == "auto") return Displaced::kByMemory;
  if (name == "patches") return Displaced::kAsPatches;
  if (name == "tessellate") return Displaced::kAsTriangles;
  if (name != "none") bad_choice("displacement", name, "auto, patches, tessellate or none");
  return Displaced::kNot;
}

CurveStyle curves_from(Arguments& arguments) {
  const std::string name = arguments.value_or("curves", std::string("ribbon"), "a str");
  if (name == "tube") return CurveStyle::kTube;
  if (name != "ribbon") bad_choice("curves", name, "ribbon or tube");
  return CurveStyle::kRibbon;
}

TranslatorSettings settings_from(Arguments& arguments) {
  TranslatorSettings settings;
  settings.width = arguments.value<std::uint32_t>("width", "an int of at least 1");
  settings.height = arguments.value<std::uint32_t>("height", "an int of at least 1");
  if (!arguments.optional("motion_tolerance").is_none()) {
    settings.motion_tolerance_pixels = arguments.value<double>("motion_tolerance", "a float");
  }
  if (!arguments.optional("outside_tolerance").is_none()) {
    settings.outside_tolerance = arguments.value<double>("outside_tolerance", "a float");
  }
  if (!arguments.optional("max_segments").is_none()) {
    settings.max_segments = arguments.value<std::uint32_t>("max_segments", "an int");
  }
  settings.choice = choice_from(arguments, settings.max_segments);
  if (!arguments.optional("keep_faces").is_none())
    settings.keep_faces = arguments.value<bool>("keep_faces", "a bool");
  if (!arguments.optional("measure_shape").is_none())
    settings.measure_shape = arguments.value<bool>("measure_shape", "a bool");
  if (!arguments.optional("edge_length").is_none())
    settings.edge_length_pixels = arguments.value<double>("edge_length", "a float");
  settings.displaced = displaced_from(arguments);
  if (!arguments.optional("displaced_triangle_bytes").is_none())
    settings.displaced_triangle_bytes = arguments.value<std::uint64_t>("displaced_triangle_bytes", "an int");
  settings.curves = curves_from(arguments);
  if (!arguments.optional("max_bounces").is_none())
    settings.max_bounces = arguments.value<std::uint32_t>("max_bounces", "an int or None");
  return settings;
}

std::shared_ptr<RefinementCache> refinements_from(Arguments& arguments) {
  const nb::object given = arguments.optional("refinements");
  if (given.is_none()) return nullptr;
  if (!nb::isinstance<RefinementCache>(given))
    arguments.fail("refinements", given, "a RefinementCache or None");
  return nb::cast<std::shared_ptr<RefinementCache>>(given);
}

void add_mesh(Translator& translator, const MeshObject& mesh) {
  Borrowed borrowed;
  const MeshInput input = mesh.input(borrowed);
  nb::gil_scoped_release release;
  translator.add_mesh(input);
}

void add_prototype_mesh(Translator& translator, std::uint32_t prototype, const MeshObject& mesh) {
  Borrowed borrowed;
  const MeshInput input = mesh.input(borrowed);
  nb::gil_scoped_release release;
  translator.add_prototype_mesh(prototype, input);
}

// The arrays of point instancers among the levels.
using LevelPoints = std::deque<PointInstancerInput>;

LevelPoints levels_from(Arguments& arguments, InstancesInput& input) {
  const nb::object list = arguments.required("levels");
  if (!nb::isinstance<nb::sequence>(list)) arguments.fail("levels", list, "a list of InstanceLevels");
  LevelPoints points;
  for (const nb::handle item : list) {
    if (!nb::isinstance<LevelObject>(item)) arguments.fail("levels", item, "an InstanceLevel for each");
    const LevelObject& level = *nb::inst_ptr<LevelObject>(item);
    input.levels.push_back(level.input(arguments.borrowed(), points.emplace_back()));
  }
  return points;
}

void add_instances(Translator& translator, const nb::kwargs& keywords) {
  Arguments arguments(keywords, "add_instances");
  InstancesInput input;
  input.path = arguments.value<std::string>("path", "a str");
  input.prototype = arguments.value<std::uint32_t>("prototype", "an int");
  const LevelPoints points = levels_from(arguments, input);
  input.visible = visible_from(arguments.optional("visible"));
  const nb::object colors = arguments.optional("display_color");
  if (nb::isinstance<nb::list>(colors)) {
    arguments.borrowed().primvar_samples(colors, "display_color", input.display_color);
  } else if (!colors.is_none()) {
    input.display_color.values = arguments.borrowed().vectors(colors, "display_color");
  }
  const nb::object opacities = arguments.optional("display_opacity");
  if (!opacities.is_none())
    input.display_opacity = arguments.borrowed().scalars(opacities, "display_opacity");
  input.primvars = named_from(arguments.optional("primvars"), "primvars", arguments.borrowed());
  input.materials = arguments.ints("materials");
  input.paths = arguments.value_or("paths", std::vector<std::string>{}, "a list of str");
  input.report_whole = arguments.value_or("report_whole", false, "a bool");
  input.ids = arguments.ints("ids");
  arguments.expect_no_more();
  nb::gil_scoped_release release;
  translator.add_instances(input);
}

double pixels_per_unit(const Translator& translator, const nb::kwargs& keywords) {
  Arguments arguments(keywords, "pixels_per_unit");
  InstancesInput input;
  const LevelPoints points = levels_from(arguments, input);
  const AnyArray box = checked_array<double>(arguments.required("box"), "box", {2, 3});
  arguments.expect_no_more();
  const std::span<const Vec3d> ends = elements<Vec3d>(box);
  const Box3d bounds{ends[0], ends[1]};
  nb::gil_scoped_release release;
  return translator.pixels_per_unit(input, bounds);
}

const char* severity_name(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "note";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      break;
  }
  return "error";
}

void bind_reports(nb::module_& m) {
  nb::class_<Diagnostic>(m, "Diagnostic")
      .def_prop_ro("severity", [](const Diagnostic& d) { return severity_name(d.severity); })
      .def_ro("path", &Diagnostic::path)
      .def_ro("attribute", &Diagnostic::attribute)
      .def_ro("message", &Diagnostic::message)
      .def_ro("in_common", &Diagnostic::in_common);
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
      .def_ro("error_pixels", &TrackReport::error_pixels)
      .def_ro("tolerance_pixels", &TrackReport::tolerance_pixels)
      .def_ro("error_outside", &TrackReport::error_outside)
      .def_ro("outside", &TrackReport::outside)
      .def_ro("coarser", &TrackReport::coarser)
      .def_ro("keys_saved", &TrackReport::keys_saved)
      .def_ro("shape_error_pixels", &TrackReport::shape_error_pixels);
}

nb::list left_out(const Translator& translator) {
  nb::list result;
  for (const LeftOut& prim : translator.left_out()) {
    nb::dict row;
    row["path"] = prim.path;
    row["why"] = prim.why == Unreached::kHidden ? "hidden" : "outside the picture";
    row["count"] = prim.count;
    result.append(row);
  }
  return result;
}

void bind_refinements(nb::module_& m) {
  nb::class_<RefinementCache>(m, "RefinementCache")
      .def(nb::init<std::size_t>(), nb::arg("most_bytes") = RefinementCache::kMostBytes)
      .def_prop_ro("bytes", &RefinementCache::bytes)
      .def_prop_ro("counts", [](const RefinementCache& cache) {
        const RefinementCounts& counts = cache.counts();
        nb::dict result;
        result["cages_made"] = counts.cages_made;
        result["cages_kept"] = counts.cages_kept;
        result["meshes_made"] = counts.meshes_made;
        result["meshes_kept"] = counts.meshes_kept;
        return result;
      });
}

}  // namespace

void bind_translator(nb::module_& m) {
  bind_reports(m);
  bind_refinements(m);
  nb::class_<Translator>(m, "Translator")
      .def("__init__",
           [](Translator* self, const nb::kwargs& keywords) {
             Arguments arguments(keywords, "Translator");
             const CameraInput camera = camera_from(arguments);
             const TranslatorSettings settings = settings_from(arguments);
             std::shared_ptr<RefinementCache> refinements = refinements_from(arguments);
             arguments.expect_no_more();
             new (self) Translator(camera, settings, std::move(refinements));
           })
      .def("add_mesh", &add_mesh, nb::arg("mesh"))
      .def("begin_prototype", &Translator::begin_prototype, nb::arg("path"), nb::arg("pixels_per_unit") = 0.0)
      .def("pixels_per_unit", &pixels_per_unit)
      .def("add_prototype_mesh", &add_prototype_mesh, nb::arg("prototype"), nb::arg("mesh"))
      .def("add_instances", &add_instances)
      .def("add_material", &Translator::add_material, nb::arg("look"),
           nb::arg("displacement").none() = nb::none())
      .def("add_light", &add_light)
      .def("keep_primvar", &Translator::keep_primvar, nb::arg("name"))
      .def("set_light_groups", &Translator::set_light_groups, nb::arg("groups"))
      .def_prop_ro("empty", &Translator::empty)
      .def_prop_ro("empty_meshes", &Translator::empty_meshes)
      .def("diagnostics", &Translator::diagnostics, nb::rv_policy::copy)
      .def("tracks", &Translator::tracks, nb::rv_policy::copy)
      .def("left_out", &left_out)
      .def("finish", [](Translator& translator) {
        const Vec3d origin = translator.origin();
        return SceneHandle{translator.finish(), origin};
      });
}

}  // namespace msbvh::python
