#include "delegate/translate/mesh_lights.h"

#include <algorithm>
#include <cmath>

#include "core/motion/track.h"
#include "core/shade/light/light.h"
#include "core/shade/light/mesh_light.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {
namespace {

// Share by which the area of a moving mesh may differ between keys and still count as the same: rigid motion
// changes it by roundings.
constexpr double kSameArea = 1e-4;

// Of one that changes, at least: its radiance is linear between keys, and its area is not.
constexpr std::uint32_t kAreaSegments = 32;

bool holds(const std::vector<GeometryId>& geometry, std::uint32_t mesh) {
  return std::ranges::find(geometry, mesh_id(mesh)) != geometry.end();
}

std::vector<LightSurface> places_of(const std::string& path, const Scene& scene) {
  std::vector<LightSurface> places;
  for (std::uint32_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
    if (scene.meshes[mesh].shape.name != path || scene.meshes[mesh].shape.triangles.empty()) continue;
    if (holds(scene.world, mesh)) places.push_back({mesh});
    for (std::uint32_t set = 0; set < scene.instances.size(); ++set) {
      if (!holds(scene.prototypes[scene.instances[set].prototype].geometry, mesh)) continue;
      for (std::uint32_t i = 0; i < instance_count(scene.instances[set]); ++i)
        places.push_back({mesh, set, i});
    }
  }
  return places;
}

std::uint32_t segments_at(const LightSurface& place, const Scene& scene) {
  const std::uint32_t own = scene.meshes[place.mesh].shape.segments;
  return place.set == LightSurface::kNoSet ? own : std::max(own, scene.instances[place.set].segments);
}

bool is_remapped(const LightSurface& place, const Scene& scene) {
  if (place.set == LightSurface::kNoSet) return false;
  const InstanceSet& set = scene.instances[place.set];
  return !set.time_remap.is_shutter() || !scene.prototypes[set.prototype].time_remap.is_shutter();
}

// By the area in the world, over the shutter.
void normalize(const Scene& scene, Light& light) {
  const MeshLight mesh(scene, light, nullptr);
  const std::uint32_t own = segments_at(light.surface, scene);
  const std::uint32_t moving =
      own > 0 || is_remapped(light.surface, scene) ? std::max(own, kAreaSegments) : 0;
  std::vector<double> areas;
  for (std::uint32_t key = 0; key < key_count(moving); ++key)
    areas.push_back(mesh.area(static_cast<float>(key_time(key, moving))));
  const auto [least, most] = std::ranges::minmax(areas);
  const auto over = [](LightValues values, double area) {
    if (area > 0.0) values.radiance = values.radiance * static_cast<float>(1.0 / area);
    return values;
  };
  if (most - least <= kSameArea * most) {
    static_cast<LightValues&>(light) = over(light, areas[0]);
    for (LightValues& values : light.moving_values) values = over(values, areas[0]);
    return;
  }
  const Light given = light;
  light.segments = std::max(given.moving_values.empty() ? 0 : given.segments, moving);
  light.moving_values.clear();
  light.world_from_light.clear();
  for (std::uint32_t key = 0; key < key_count(light.segments); ++key) {
    const auto time = static_cast<float>(key_time(key, light.segments));
    light.moving_values.push_back(over(values_at(given, time), mesh.area(time)));
  }
  static_cast<LightValues&>(light) = light.moving_values.front();
}

// What the bound material's glow multiplies the light's colour by: 1 where there is none.
Vec3f glow_of(const Mesh& mesh, const Scene& scene, PrimLog& log) {
  const Vec3f none{1.0f, 1.0f, 1.0f};
  const std::uint32_t bound = mesh.triangle_materials.empty() ? mesh.material : mesh.triangle_materials[0];
  if (bound == kNone) return none;
  const auto same = [&](std::uint32_t material) { return material == bound; };
  const Material& material = scene.materials[bound];
  const auto drives_glow = [](const DrivenInput& driven) {
    return driven.input == SurfaceInput::kEmissiveColor;
  };
  if (!std::ranges::all_of(mesh.triangle_materials, same) || material.emissive_from_display_color ||
      std::ranges::any_of(material.driven, drives_glow)) {
    log.warn("light:materialSyncMode",
             "the material's glow varies over the mesh; its light is not tinted by it, only by inputs:color");
    return none;
  }
  return material.emissive_color == Vec3f{} ? none : material.emissive_color;
}

// Black, and as bright as the light.
void wear_light(const Light& light, Scene& scene) {
  Mesh& mesh = scene.meshes[light.surface.mesh];
  scene.materials.push_back(
      {.name = light.name, .diffuse_color = {}, .emissive_color = values_at(light, 0.5f).radiance});
  mesh.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  mesh.triangle_materials.clear();
  mesh.display_opacity = {};
}

}  // namespace

void add_stand_ins(const std::vector<MeshLightDraft>& drafts, Scene& scene) {
  for (const MeshLightDraft& draft : drafts) scene.lights.push_back(draft.light);
}

void place_mesh_lights(const std::vector<MeshLightDraft>& drafts, Scene& scene,
                       std::vector<Diagnostic>& diagnostics) {
  scene.lights.resize(scene.lights.size() - drafts.size());
  for (const MeshLightDraft& draft : drafts) {
    PrimLog log(diagnostics, draft.light.name);
    const std::vector<LightSurface> places = places_of(draft.surface.path, scene);
    if (places.empty()) {
      log.warn("",
               message("found no triangles that are drawn at ", draft.surface.path, "; it gives no light"));
      continue;
    }
    const Vec3f tint = draft.surface.sync == MaterialSync::kGlowTintsLight
                           ? glow_of(scene.meshes[places[0].mesh], scene, log)
                           : Vec3f{1.0f, 1.0f, 1.0f};
    std::uint32_t worn = LightSurface::kNoSet;
    for (const LightSurface& place : places) {
      Light light = draft.light;
      light.surface = place;
      if (draft.surface.normalize) normalize(scene, light);
      light.radiance = light.radiance * tint;
      for (LightValues& values : light.moving_values) values.radiance = values.radiance * tint;
      if (draft.surface.sync == MaterialSync::kNoMaterial && place.mesh != worn) wear_light(light, scene);
      worn = place.mesh;
      scene.lights.push_back(std::move(light));
    }
  }
}

}  // namespace msbvh::translate
