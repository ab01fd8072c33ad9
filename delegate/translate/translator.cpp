#include "delegate/translate/translator.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "core/base/box.h"
#include "core/base/error.h"
#include "core/base/stretch.h"
#include "delegate/translate/camera.h"
#include "delegate/translate/coarser_tally.h"
#include "delegate/translate/instances.h"
#include "delegate/translate/light.h"
#include "delegate/translate/material_table.h"
#include "delegate/translate/mesh.h"
#include "delegate/translate/mesh_lights.h"
#include "delegate/translate/outside.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

void check_settings(const TranslatorSettings& settings) {
  if (settings.width == 0 || settings.height == 0) {
    throw Error(
        message("image size: found ", settings.width, " x ", settings.height, "; expected at least 1 x 1"));
  }
  if (!(settings.motion_tolerance_pixels > 0.0) || !std::isfinite(settings.motion_tolerance_pixels)) {
    throw Error(message("motion tolerance: found ", settings.motion_tolerance_pixels,
                        " pixels; expected a finite number above 0"));
  }
  if (!(settings.outside_tolerance >= 1.0) || !std::isfinite(settings.outside_tolerance)) {
    throw Error(message("outside tolerance: found ", settings.outside_tolerance,
                        " times the motion tolerance; expected a finite number of at least 1"));
  }
  if (!(settings.edge_length_pixels >= 0.0) || !std::isfinite(settings.edge_length_pixels)) {
    throw Error(message("edge length: found ", settings.edge_length_pixels,
                        " pixels; expected a finite number that is not negative"));
  }
  if (!is_valid_segment_count(settings.max_segments)) {
    throw Error(message("max_segments: found ", settings.max_segments,
                        "; expected 0 or a power of two up to ", kMaxSegments));
  }
}

// What instances need to know of their prototype while the scene grows.
struct PrototypeState {
  std::string path;
  MeshTarget target;
  Box3d box;  // of its meshes at all their controls
  // How far its implicit shapes stray from the true ones at most; kept where the prototype's size in the
  // picture is not known.
  double stray = 0.0;
  // The scene's prototypes that it takes: one for each time remap among its meshes.
  std::vector<std::uint32_t> parts{};
};

// Trees number each kind apart.
void sort_by_kind(std::vector<GeometryId>& geometry) {
  std::ranges::stable_sort(geometry, {}, [](GeometryId id) { return id.kind(); });
}

// MeshInput::stray in the space that the mesh is placed in.
double placed_stray(const MeshInput& input) {
  double stretch = 0.0;
  for (const Matrix4d& matrix : input.world_from_object.matrices)
    stretch = std::max(stretch, largest_stretch(affine_from(matrix)));
  return input.stray * stretch;
}

}  // namespace

struct Translator::Data {
  Data(const CameraInput& camera, const TranslatorSettings& settings_, std::shared_ptr<RefinementCache> kept)
      : settings(settings_),
        fit{settings.motion_tolerance_pixels, settings.max_segments, settings.choice},
        origin(settings.origin ? *settings.origin : frame_origin(camera)),
        measure(camera, origin, settings.width, settings.height),
        refinements(kept ? std::move(kept) : std::make_shared<RefinementCache>()) {}

  // Keeps the track and counts what has nothing to draw.
  std::optional<TranslatedMesh> translated(const MeshInput& input, MeshTarget& target);
  MeshTarget target(const ScreenMeasure* in_world);
  // The geometry into the scene.
  GeometryId add(TranslatedMesh& translated);
  // Whether it is hidden throughout the shutter; notes it.
  bool is_hidden(const TranslatedMesh& translated);
  void add_instanced(TranslatedMesh translated);
  void note_coarser(const TranslatedInstances& found, std::size_t parts);
  std::uint32_t part_with(const TimeRemap& time_remap, PrototypeState& state);

  TranslatorSettings settings;
  std::uint64_t triangle_bytes_left = settings.displaced_triangle_bytes;
  FitSettings fit;
  Vec3d origin;
  ScreenMeasure measure;
  std::optional<Outside> outside;  // none: one tolerance for all
  std::shared_ptr<RefinementCache> refinements;
  Scene scene;
  MaterialTable materials;
  std::vector<std::optional<Displacement>> displacements;  // by material
  std::vector<PrototypeState> prototypes;
  LightGroups light_groups;
  std::vector<MeshLightDraft> mesh_lights;
  std::vector<Diagnostic> diagnostics;
  std::vector<TrackReport> tracks;
  std::size_t empty_meshes = 0;
  std::vector<LeftOut> left_out;
  CoarserTally coarser;
};

MeshTarget Translator::Data::target(const ScreenMeasure* in_world) {
  MeshTarget result{in_world,
                    0.0,
                    std::nullopt,
                    settings.width,
                    settings.height,
                    fit,
                    0,
                    settings.keep_faces,
                    settings.measure_shape,
                    settings.edge_length_pixels,
                    {},
                    settings.displaced,
                    &triangle_bytes_left,
                    settings.curves,
                    refinements.get(),
                    nullptr,
                    &materials};
  if (in_world) {
    result.origin = origin;
    result.outside = outside ? &*outside : nullptr;
  }
  return result;
}

std::optional<TranslatedMesh> Translator::Data::translated(const MeshInput& input, MeshTarget& target) {
  PrimLog log(diagnostics, input.path);
  target.material_count = std::uint32_t(scene.materials.size());
  target.displacements = displacements;
  std::optional<TranslatedMesh> result = translate_mesh(input, target, log);
  if (result) {
    result->look().prim_id = input.prim_id;
    if (!target.measure) result->track.count = 0;
    tracks.push_back(result->track);
  } else if (!log.rejected()) {
    ++empty_meshes;
  }
  return result;
}

GeometryId Translator::Data::add(TranslatedMesh& translated) {
  if (translated.grids) {
    scene.grids.push_back(std::move(*translated.grids));
    return {GeometryKind::kGridMesh, std::uint32_t(scene.grids.size() - 1)};
  }
  if (translated.curves) {
    scene.curves.push_back(std::move(*translated.curves));
    return curves_id(std::uint32_t(scene.curves.size() - 1));
  }
  if (translated.points) {
    scene.points.push_back(std::move(*translated.points));
    return points_id(std::uint32_t(scene.points.size() - 1));
  }
  scene.meshes.push_back(std::move(translated.mesh));
  return mesh_id(std::uint32_t(scene.meshes.size() - 1));
}

bool Translator::Data::is_hidden(const TranslatedMesh& translated) {
  if (translated.never_seen) {
    left_out.push_back({translated.name(), Unreached::kHidden});
    tracks.back().coarser = tracks.back().keys_saved = 0;
  }
  return translated.never_seen;
}

// One instance, which carries the transform's track or, of a baked mesh, only brings it into the time remap's
// time.
void Translator::Data::add_instanced(TranslatedMesh translated) {
  const std::string name = translated.name();
  const auto prototype = std::uint32_t(scene.prototypes.size());
  const bool baked = translated.world_from_mesh.empty();
  scene.prototypes.push_back({name, {add(translated)}, baked ? translated.time_remap : TimeRemap{}});
  InstanceSet set{name, prototype, 0, {Affine3f{}}, {}};
  set.ids = {-1};
  if (!baked) {
    set.segments = translated.track.segments;
    set.degree = translated.track.degree;
    set.world_from_prototype = std::move(translated.world_from_mesh);
    set.time_remap = translated.time_remap;
  }
  coarser.add({scene.instances.size()},
              {{tracks.size() - 1, tracks.back().coarser, tracks.back().keys_saved}});
  scene.instances.push_back(std::move(set));
}

// Before the sets are added, once for each of a prototype's parts.
void Translator::Data::note_coarser(const TranslatedInstances& found, std::size_t parts) {
  for (std::size_t i = 0; i < found.savings.size(); ++i) {
    std::vector<std::size_t> sets;
    for (std::size_t part = 0; part < parts; ++part) {
      sets.push_back(scene.instances.size() + part * found.sets.size() + i);
    }
    std::vector<Saving> savings = found.savings[i];
    for (Saving& saving : savings) saving.report += tracks.size();
    coarser.add(std::move(sets), std::move(savings));
  }
}

std::uint32_t Translator::Data::part_with(const TimeRemap& time_remap, PrototypeState& state) {
  for (const std::uint32_t part : state.parts) {
    if (scene.prototypes[part].time_remap == time_remap) return part;
  }
  scene.prototypes.push_back({state.path, {}, time_remap});
  state.parts.push_back(std::uint32_t(scene.prototypes.size() - 1));
  return state.parts.back();
}

Translator::Translator(const CameraInput& camera, const TranslatorSettings& settings,
                       std::shared_ptr<RefinementCache> refinements) {
  check_settings(settings);
  check_camera(camera);
  data_ = std::make_unique<Data>(camera, settings, std::move(refinements));
  TrackReport track;
  data_->scene.camera = fit_camera(camera, data_->origin, settings, track);
  if (settings.outside_tolerance > 1.0 && settings.choice.segments == 0)
    data_->outside.emplace(
        Outside{{data_->scene.camera, settings.width, settings.height}, settings.outside_tolerance});
  track.source = "camera";
  track.tolerance_pixels = settings.motion_tolerance_pixels;
  track.rule = track.segments == 0 ? "still" : "transform and optics by the stage's own evaluation";
  data_->tracks.push_back(track);
  PrimLog log(data_->diagnostics, camera.path);
  report_fit({track.segments, track.error_pixels}, data_->fit, "xformOpOrder",
             "the camera's motion, zoom or focus", log);
}

Translator::~Translator() = default;

void Translator::add_mesh(const MeshInput& input) {
  MeshTarget world = data_->target(&data_->measure);
  std::optional<TranslatedMesh> translated = data_->translated(input, world);
  if (!translated || data_->is_hidden(*translated)) return;
  if (translated->world_from_mesh.empty() && translated->time_remap.is_shutter()) {
    data_->scene.world.push_back(data_->add(*translated));
    data_->coarser.add(data_->scene.world.back(), data_->tracks.back(), data_->tracks.size() - 1);
  } else {
    data_->add_instanced(std::move(*translated));
  }
}

std::uint32_t Translator::begin_prototype(const std::string& path, double pixels_per_unit) {
  data_->prototypes.push_back({path, data_->target(nullptr), {}});
  data_->prototypes.back().target.pixels_per_unit = pixels_per_unit;
  return std::uint32_t(data_->prototypes.size() - 1);
}

double Translator::pixels_per_unit(const InstancesInput& input, const Box3d& box) const {
  return translate::pixels_per_unit(
      input, {data_->measure, data_->origin, {}, box, data_->fit, 0, nullptr, nullptr});
}

void Translator::add_prototype_mesh(std::uint32_t prototype, const MeshInput& input) {
  if (prototype >= data_->prototypes.size()) {
    PrimLog(data_->diagnostics, input.path)
        .reject("prototype", message("found ", prototype, "; expected one of ", data_->prototypes.size()));
    return;
  }
  PrototypeState& state = data_->prototypes[prototype];
  std::optional<TranslatedMesh> translated = data_->translated(input, state.target);
  if (!translated || data_->is_hidden(*translated)) return;
  state.box.grow(translated->box());
  if (input.stray > 0.0 && !(state.target.pixels_per_unit > 0.0))
    state.stray = std::max(state.stray, placed_stray(input));
  const std::uint32_t part = data_->part_with(translated->time_remap, state);
  data_->scene.prototypes[part].geometry.push_back(data_->add(*translated));
}

void Translator::add_instances(const InstancesInput& input) {
  PrimLog log(data_->diagnostics, input.path);
  if (input.prototype >= data_->prototypes.size()) {
    log.reject("prototypes",
               message("found prototype ", input.prototype, "; expected one of ", data_->prototypes.size()));
    return;
  }
  const PrototypeState& state = data_->prototypes[input.prototype];
  if (state.box.empty() || input.levels.empty()) return;  // nothing to draw; its meshes have been reported
  const Vec3d prototype_origin = state.target.origin.value_or(Vec3d{});
  const InstanceTarget target{data_->measure,
                              data_->origin,
                              prototype_origin,
                              state.box,
                              data_->fit,
                              std::uint32_t(data_->scene.materials.size()),
                              data_->outside ? &*data_->outside : nullptr,
                              &data_->materials};
  TranslatedInstances result = translate_instances(input, target, log);
  if (result.sets.empty()) return;
  if (data_->settings.measure_shape && state.stray > 0.0) {
    const double pixels = state.stray * translate::pixels_per_unit(input, target);
    for (TrackReport& track : result.tracks) {
      if (std::isfinite(pixels)) track.shape_error_pixels = pixels;
    }
  }
  data_->note_coarser(result, state.parts.size());
  for (const std::uint32_t part : state.parts) {
    for (InstanceSet& set : result.sets) {
      set.prototype = part;
      data_->scene.instances.push_back(set);
    }
  }
  data_->tracks.insert(data_->tracks.end(), result.tracks.begin(), result.tracks.end());
}

std::uint32_t Translator::add_material(SurfaceLook look, std::optional<Displacement> displacement) {
  PrimLog log(data_->diagnostics, look.material.name);
  if (data_->settings.displaced == Displaced::kNot) displacement.reset();
  const std::uint32_t number = data_->materials.add(std::move(look), data_->scene, log);
  data_->displacements.push_back(std::move(displacement));
  return number;
}

void Translator::keep_primvar(const std::string& name) { data_->materials.keep(name, data_->scene); }

void Translator::add_light(const LightInput& input) {
  PrimLog log(data_->diagnostics, input.light.name);
  std::optional<Light> light = translate_light(input, data_->measure, data_->origin, data_->settings.width,
                                               data_->settings.height, data_->fit, log);
  if (!light) return;
  if (light->kind == LightKind::kMesh) {
    data_->mesh_lights.push_back({std::move(*light), input.surface});
  } else {
    data_->scene.lights.push_back(std::move(*light));
  }
}

void Translator::set_light_groups(LightGroups groups) { data_->light_groups = std::move(groups); }

bool Translator::empty() const { return data_->scene.world.empty() && data_->scene.instances.empty(); }

std::size_t Translator::empty_meshes() const { return data_->empty_meshes; }

const std::vector<Diagnostic>& Translator::diagnostics() const { return data_->diagnostics; }

const std::vector<TrackReport>& Translator::tracks() const { return data_->tracks; }

Vec3d Translator::origin() const { return data_->origin; }

const std::vector<LeftOut>& Translator::left_out() const { return data_->left_out; }

std::shared_ptr<const Scene> Translator::finish() {
  assign_light_groups(data_->light_groups, data_->scene);
  sort_by_kind(data_->scene.world);
  for (Prototype& prototype : data_->scene.prototypes) sort_by_kind(prototype.geometry);
  const TranslatorSettings& settings = data_->settings;
  add_stand_ins(data_->mesh_lights, data_->scene);
  std::vector<LeftOut> found =
      leave_out_unreached(data_->scene, settings.width, settings.height, settings.max_bounces);
  place_mesh_lights(data_->mesh_lights, data_->scene, data_->diagnostics);
  data_->coarser.leave_out(found, data_->tracks);
  data_->coarser = {};
  std::ranges::move(found, std::back_inserter(data_->left_out));
  auto scene = std::make_shared<Scene>(std::move(data_->scene));
  data_->scene = {};
  data_->scene.camera = scene->camera;
  data_->prototypes.clear();
  return scene;
}

}  // namespace msbvh::translate
