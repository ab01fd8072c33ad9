#include "core/plan/effect_plan.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "core/scene/opacity.h"

namespace msbvh {
namespace {

constexpr std::array<std::pair<Effect, const char*>, 13> kNames{{
    {Effect::kDeformingKeys, "deforming keys"},
    {Effect::kInstances, "instances"},
    {Effect::kMovingInstances, "moving instances"},
    {Effect::kCameraMotion, "camera motion"},
    {Effect::kMovingLights, "moving lights"},
    {Effect::kOpacity, "opacity"},
    {Effect::kAreaLights, "area lights"},
    {Effect::kDomeLight, "dome light"},
    {Effect::kIndirectLight, "indirect light"},
    {Effect::kLens, "lens"},
    {Effect::kPolynomialMotion, "polynomial motion"},
    {Effect::kTimeRemaps, "time remaps"},
    {Effect::kAovs, "AOVs"},
}};

// Collects the first reason of each effect.
class Planner {
 public:
  bool needs(Effect effect) const { return plan_.set.has(effect); }
  void add(Effect effect, const std::string& prim, const std::string& why) {
    if (needs(effect)) return;
    plan_.set = plan_.set.with(effect);
    plan_.why.push_back({effect, prim, why});
  }
  EffectPlan finish() {
    std::sort(plan_.why.begin(), plan_.why.end(),
              [](const Reason& a, const Reason& b) { return a.effect < b.effect; });
    return std::move(plan_);
  }

 private:
  EffectPlan plan_;
};

std::string phrase(float number, const char* unit) {
  std::ostringstream text;
  text << number << unit;
  return text.str();
}
std::string segments_phrase(std::uint32_t segments) {
  return std::to_string(segments) + (segments == 1 ? " segment" : " segments");
}

void plan_curve(const std::string& name, const TrackForm& form, Planner& planner) {
  if (!form.moving() || form.degree == 1) return;
  planner.add(Effect::kPolynomialMotion, name,
              segments_phrase(form.segments) + (form.degree == 2 ? ", quadratic" : ", cubic"));
}

void plan_time_remap(const std::string& name, const TimeRemap& time_remap, Planner& planner) {
  if (time_remap.is_shutter()) return;
  planner.add(Effect::kTimeRemaps, name, std::to_string(time_remap.pieces.size()) + " pieces of the shutter");
}

// Meshes that something shows: in the world, or in a prototype that has instances. `own_materials`: only
// where no instance overrides their materials. In the order of the scene.
std::vector<const Mesh*> shown_meshes(const Scene& scene, bool own_materials) {
  std::vector<bool> shown(scene.meshes.size(), false);
  for (const GeometryId mesh : scene.world) shown[mesh.index()] = true;
  for (const InstanceSet& set : scene.instances) {
    if (instance_count(set) == 0 || (own_materials && !set.materials.empty())) continue;
    for (const GeometryId mesh : scene.prototypes[set.prototype].geometry) shown[mesh.index()] = true;
  }
  std::vector<const Mesh*> meshes;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (shown[i] && !scene.meshes[i].shape.triangles.empty()) meshes.push_back(&scene.meshes[i]);
  }
  return meshes;
}

void plan_meshes(const Scene& scene, Planner& planner) {
  for (const Mesh* mesh : shown_meshes(scene, false)) {
    if (mesh->shape.segments == 0) continue;
    planner.add(Effect::kDeformingKeys, mesh->shape.name, segments_phrase(mesh->shape.segments));
    plan_curve(mesh->shape.name, mesh->shape.form(), planner);
  }
}

// The first thing that is not opaque is enough: looking for the least opacity reads a whole primvar.
void plan_opacity(const Scene& scene, Planner& planner) {
  const auto found = [&](const std::string& name, float opacity) {
    if (opacity < 1.0f) planner.add(Effect::kOpacity, name, "opacity down to " + phrase(opacity, ""));
    return opacity < 1.0f;
  };
  for (const Mesh* mesh : shown_meshes(scene, true)) {
    if (found(mesh->shape.name, least_opacity(scene, *mesh))) return;
  }
  for (const InstanceSet& set : scene.instances) {
    std::vector<std::uint32_t> materials = set.materials;
    std::ranges::sort(materials);
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    for (const std::uint32_t material : materials) {
      for (const GeometryId mesh : scene.prototypes[set.prototype].geometry) {
        if (found(set.name, least_opacity(scene.mesh(mesh), material_at(scene, material)))) return;
      }
    }
  }
}

void plan_instances(const Scene& scene, Planner& planner) {
  for (const InstanceSet& set : scene.instances) {
    const std::size_t count = instance_count(set);
    if (count == 0) continue;
    planner.add(Effect::kInstances, set.name,
                std::to_string(count) + (count == 1 ? " instance" : " instances"));
    if (set.segments > 0) planner.add(Effect::kMovingInstances, set.name, segments_phrase(set.segments));
    plan_curve(set.name, set.form(), planner);
    plan_time_remap(set.name, set.time_remap, planner);
    plan_time_remap(set.name, scene.prototypes[set.prototype].time_remap, planner);
  }
}

// The largest at any key, which is what asks for sampling an extent.
float largest(const Light& light, float LightValues::*size) {
  float result = light.moving_values.empty() ? light.*size : 0.0f;
  for (const LightValues& values : light.moving_values) result = std::max(result, values.*size);
  return result;
}

void plan_light(const Light& light, Planner& planner) {
  const bool placeless = light.kind == LightKind::kDome || light.kind == LightKind::kCamera;
  if (light.segments > 0 && !(placeless && light.moving_values.empty())) {
    planner.add(Effect::kMovingLights, light.name, segments_phrase(light.segments));
  }
  if (light.kind == LightKind::kDome) planner.add(Effect::kDomeLight, light.name, "constant dome");
  const float angle = largest(light, &LightValues::angle_degrees);
  const float radius = largest(light, &LightValues::radius);
  if (light.kind == LightKind::kDistant && angle > 0.0f) {
    planner.add(Effect::kAreaLights, light.name, phrase(angle, " degrees across"));
  }
  if (light.kind == LightKind::kSphere && radius > 0.0f) {
    planner.add(Effect::kAreaLights, light.name, "radius " + phrase(radius, ""));
  }
  if (light.kind == LightKind::kRect) {
    planner.add(Effect::kAreaLights, light.name,
                phrase(largest(light, &LightValues::width), " x ") +
                    phrase(largest(light, &LightValues::height), ""));
  }
}

std::string range_phrase(float a, float b) {
  return a == b ? phrase(a, "") : phrase(a, " to ") + phrase(b, "");
}

void plan_camera(const Camera& camera, Planner& planner) {
  if (camera.segments > 0) {
    planner.add(Effect::kCameraMotion, camera.name, segments_phrase(camera.segments));
  }
  const bool open = std::any_of(camera.lens.begin(), camera.lens.end(),
                                [](const Lens& lens) { return lens.radius > 0.0f; });
  if (!open) return;
  const Lens &first = camera.lens.front(), &last = camera.lens.back();
  planner.add(Effect::kLens, camera.name,
              "radius " + range_phrase(first.radius, last.radius) + ", focus at " +
                  range_phrase(first.focus_distance, last.focus_distance));
}

}  // namespace

const char* effect_name(Effect effect) {
  for (const auto& [known, name] : kNames) {
    if (known == effect) return name;
  }
  return "unknown effect";
}

EffectPlan plan_effects(const Scene& scene, const PlanSettings& settings) {
  Planner planner;
  plan_meshes(scene, planner);
  plan_opacity(scene, planner);
  plan_instances(scene, planner);
  plan_camera(scene.camera, planner);
  for (const Light& light : scene.lights) plan_light(light, planner);
  if (settings.max_bounces > 0) {
    planner.add(Effect::kIndirectLight, "",
                "up to " + std::to_string(settings.max_bounces) +
                    (settings.max_bounces == 1 ? " bounce" : " bounces"));
  }
  if (!settings.aovs.empty()) planner.add(Effect::kAovs, "", settings.aovs);
  return planner.finish();
}

}  // namespace msbvh
