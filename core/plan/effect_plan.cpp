#include "core/plan/effect_plan.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/plan/light_reasons.h"
#include "core/plan/phrases.h"
#include "core/plan/ray_reach.h"
#include "core/scene/opacity.h"

namespace msbvh {
namespace {

constexpr std::array<std::pair<Effect, const char*>, kEffectCount> kNames{{
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
    {Effect::kCurves, "curves"},
    {Effect::kPoints, "points"},
    {Effect::kDisplacement, "displacement"},
    {Effect::kSubdivision, "subdivision"},
    {Effect::kSpecular, "specular"},
    {Effect::kTextures, "textures"},
    {Effect::kLightControls, "light controls"},
    {Effect::kImageDome, "image dome"},
    {Effect::kRefraction, "refraction"},
    {Effect::kFibre, "fibre"},
}};

enum class Collect : std::uint8_t { kFirst, kAll };

// Collects the first reason of each effect, or of each effect and prim.
class Planner {
 public:
  explicit Planner(Collect collect = Collect::kFirst) : collect_(collect) {}

  bool has(Effect effect) const { return plan_.set.has(effect); }
  bool collects_all() const { return collect_ == Collect::kAll; }
  void add(Effect effect, const std::string& prim, const std::string& why) {
    if (collects_all() ? !seen_.emplace(effect, prim).second : plan_.set.has(effect)) return;
    plan_.set = plan_.set.with(effect);
    plan_.why.push_back({effect, prim, why});
  }
  EffectPlan finish() {
    std::stable_sort(plan_.why.begin(), plan_.why.end(),
                     [](const Reason& a, const Reason& b) { return a.effect < b.effect; });
    return std::move(plan_);
  }

 private:
  Collect collect_;
  EffectPlan plan_;
  std::set<std::pair<Effect, std::string>> seen_;
};

void plan_curve(const std::string& name, const TrackForm& form, Planner& planner) {
  if (!form.moving() || form.degree == 1) return;
  planner.add(Effect::kPolynomialMotion, name,
              segments_phrase(form.segments) + (form.degree == 2 ? ", quadratic" : ", cubic"));
}

void plan_time_remap(const std::string& name, const TimeRemap& time_remap, Planner& planner) {
  if (time_remap.is_shutter()) return;
  planner.add(Effect::kTimeRemaps, name, std::to_string(time_remap.pieces.size()) + " pieces of the shutter");
}

// What a geometry says of itself, whatever its kind.
struct Shown {
  GeometryId id;
  std::string name;
  TrackForm form;
  std::size_t parts;  // triangles, spans or points
};

Shown described(const Scene& scene, GeometryId id) {
  if (id.is(GeometryKind::kCurves)) {
    const CurveSet& shape = scene.curves[id.index()].shape;
    return {id, shape.name, shape.form(), shape.spans.size()};
  }
  if (id.is(GeometryKind::kPoints)) {
    const PointSet& shape = scene.points[id.index()].shape;
    return {id, shape.name, shape.form(), shape.point_count};
  }
  if (id.is(GeometryKind::kGridMesh)) {
    const GridMesh& shape = scene.grids[id.index()].shape;
    return {id, shape.name, shape.form(), shape.triangle_count()};
  }
  const TriangleMesh& shape = scene.mesh(id).shape;
  return {id, shape.name, shape.form(), shape.triangles.size()};
}

// Geometry that something shows: in the world, or in a prototype that has instances. `own_materials`: only
// where no instance overrides its materials. Each once, kind by kind in the order of the scene.
std::vector<Shown> shown_geometry(const Scene& scene, bool own_materials) {
  std::vector<GeometryId> ids = scene.world;
  for (const InstanceSet& set : scene.instances) {
    if (instance_count(set) == 0 || (own_materials && !set.materials.empty())) continue;
    const std::vector<GeometryId>& geometry = scene.prototypes[set.prototype].geometry;
    ids.insert(ids.end(), geometry.begin(), geometry.end());
  }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<Shown> shown;
  for (const GeometryId id : ids) {
    Shown one = described(scene, id);
    if (one.parts > 0) shown.push_back(std::move(one));
  }
  return shown;
}

const char* shape_phrase(CurveShape shape) {
  return shape == CurveShape::kTube       ? " spans, round"
         : shape == CurveShape::kOriented ? " spans, flat, across their normals"
                                          : " spans, flat, turned to the ray";
}

float displaced_by(const Scene& scene, GeometryId id) {
  if (id.is(GeometryKind::kTriangleMesh)) return scene.mesh(id).displaced_by;
  return id.is(GeometryKind::kGridMesh) ? scene.grids[id.index()].displaced_by : 0.0f;
}

void plan_kind(const Scene& scene, const Shown& shown, Planner& planner) {
  const std::string parts = std::to_string(shown.parts);
  if (shown.id.is(GeometryKind::kCurves)) {
    const Curves& curves = scene.curves[shown.id.index()];
    planner.add(Effect::kCurves, shown.name, parts + shape_phrase(curves.shape.shape));
    if (curves.fibre) {
      planner.add(Effect::kFibre, shown.name, parts + " spans of hair");
      planner.add(Effect::kSpecular, shown.name, "light in hair");
    }
  }
  if (shown.id.is(GeometryKind::kPoints)) planner.add(Effect::kPoints, shown.name, parts + " spheres");
  if (shown.id.is(GeometryKind::kTriangleMesh) && scene.mesh(shown.id).cage_faces > 0) {
    planner.add(Effect::kSubdivision, shown.name,
                "limit surface of " + std::to_string(scene.mesh(shown.id).cage_faces) + " faces, " + parts +
                    " triangles");
  }
  const float by = displaced_by(scene, shown.id);
  if (by == 0.0f) return;
  const bool patches = shown.id.is(GeometryKind::kGridMesh);
  planner.add(Effect::kDisplacement, shown.name,
              "up to " + phrase(by, patches ? " along the normal, as patches" : " along the normal"));
}

void plan_geometry(const Scene& scene, Planner& planner) {
  for (const Shown& shown : shown_geometry(scene, false)) {
    plan_kind(scene, shown, planner);
    if (!shown.form.moving()) continue;
    planner.add(Effect::kDeformingKeys, shown.name, segments_phrase(shown.form.segments));
    plan_curve(shown.name, shown.form, planner);
  }
}

// The first thing that is not opaque is enough, unless all are asked for: looking for the least opacity reads
// a whole primvar.
void plan_opacity(const Scene& scene, Planner& planner) {
  const auto found = [&](const std::string& name, float opacity) {
    if (opacity < 1.0f) planner.add(Effect::kOpacity, name, "opacity down to " + phrase(opacity, ""));
    return opacity < 1.0f && !planner.collects_all();
  };
  for (const Shown& shown : shown_geometry(scene, true)) {
    if (found(shown.name, least_opacity(scene, shown.id))) return;
  }
  for (const InstanceSet& set : scene.instances) {
    if (!set.display_opacity.empty() && found(set.name, *std::ranges::min_element(set.display_opacity)))
      return;
    std::vector<std::uint32_t> materials = set.materials;
    std::ranges::sort(materials);
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    for (const std::uint32_t material : materials) {
      for (const GeometryId id : scene.prototypes[set.prototype].geometry) {
        if (found(set.name, least_opacity(*scene.appearance(id), material_at(scene, material)))) return;
      }
    }
  }
}

// A material, and the first thing that shows it.
struct ShownMaterial {
  std::string name;
  std::uint32_t material;
};

// Each once, unless all reasons are asked for: then each of each thing.
std::vector<ShownMaterial> shown_materials(const Scene& scene, bool all) {
  std::vector<ShownMaterial> shown;
  std::set<std::uint32_t> seen;
  const auto add = [&](const std::string& name, std::vector<std::uint32_t> materials) {
    std::ranges::sort(materials);
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    for (const std::uint32_t material : materials) {
      if (material != kNone && (seen.insert(material).second || all)) shown.push_back({name, material});
    }
  };
  for (const Shown& geometry : shown_geometry(scene, true)) {
    const GeometryId id = geometry.id;
    const bool parts = id.is(GeometryKind::kTriangleMesh) && !scene.mesh(id).triangle_materials.empty();
    const bool patches = id.is(GeometryKind::kGridMesh) && !scene.grids[id.index()].grid_materials.empty();
    add(geometry.name, parts     ? scene.mesh(id).triangle_materials
                       : patches ? scene.grids[id.index()].grid_materials
                                 : std::vector{scene.appearance(id)->material});
  }
  for (const InstanceSet& set : scene.instances) add(set.name, set.materials);
  return shown;
}

const char* input_name(SurfaceInput input) {
  constexpr const char* kInputs[] = {"diffuseColor", "emissiveColor", "specularColor",      "metallic",
                                     "roughness",    "clearcoat",     "clearcoatRoughness", "opacity",
                                     "ior",          "normal"};
  return kInputs[static_cast<std::size_t>(input)];
}

std::string driven_phrase(const Scene& scene, const Material& material) {
  const DrivenInput& first = material.driven.front();
  const bool texture = first.source == DrivenInput::Source::kTexture;
  const std::string from = texture ? scene.textures[material.texture_reads[first.index].texture].name
                                   : "primvars:" + scene.primvar_names[first.index];
  const std::size_t others = material.driven.size() - 1;
  return std::string(input_name(first.input)) + " of " + material.name + " from " + from +
         (others == 0 ? "" : ", and " + std::to_string(others) + (others == 1 ? " other" : " others"));
}

std::string specular_phrase(const Material& material) {
  std::string phrase_of = "roughness " + phrase(material.roughness, "") + " of " + material.name;
  if (material.metallic > 0.0f) phrase_of += ", metallic " + phrase(material.metallic, "");
  if (material.clearcoat > 0.0f) phrase_of += ", clearcoat " + phrase(material.clearcoat, "");
  return phrase_of;
}

// By its constant, or by what drives it.
bool may_be_transparent(const Material& material) {
  return constant_opacity(&material) < 1.0f || drives_opacity(&material) ||
         material.opacity_from_display_opacity;
}

void plan_refraction(const std::string& name, const Material& material, Planner& planner) {
  if (material.specular && material.transparent_reflects && may_be_transparent(material))
    planner.add(Effect::kRefraction, name, "ior " + phrase(material.ior, " of ") + material.name);
}

void plan_materials(const Scene& scene, const PlanSettings& settings, Planner& planner) {
  for (const ShownMaterial& shown : shown_materials(scene, planner.collects_all())) {
    const Material& material = scene.materials[shown.material];
    if (material.specular) planner.add(Effect::kSpecular, shown.name, specular_phrase(material));
    if (!material.driven.empty()) planner.add(Effect::kTextures, shown.name, driven_phrase(scene, material));
    if (material.normal_coordinates != kNoPrimvar)
      planner.add(Effect::kTextures, shown.name, "normal of " + material.name);
    if (settings.refraction && planner.has(Effect::kOpacity)) plan_refraction(shown.name, material, planner);
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

void plan_light(const Light& light, Planner& planner) {
  for (const Reason& reason : light_reasons(light)) planner.add(reason.effect, reason.prim, reason.why);
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

namespace {

EffectPlan plan_all(const Scene& scene, const PlanSettings& settings, Planner planner) {
  plan_geometry(scene, planner);
  plan_opacity(scene, planner);
  plan_materials(scene, settings, planner);
  plan_instances(scene, planner);
  plan_camera(scene.camera, planner);
  for (const Light& light : scene.lights) plan_light(light, planner);
  // Bounces look for light: where there is none, they would find nothing.
  if (settings.max_bounces > 0 && anything_shines(scene)) {
    planner.add(Effect::kIndirectLight, "",
                "up to " + std::to_string(settings.max_bounces) +
                    (settings.max_bounces == 1 ? " bounce" : " bounces"));
  }
  if (!settings.aovs.empty()) planner.add(Effect::kAovs, "", settings.aovs);
  return planner.finish();
}

}  // namespace

EffectPlan plan_effects(const Scene& scene, const PlanSettings& settings) {
  return plan_all(scene, settings, Planner(Collect::kFirst));
}

void expect_known(const EffectPlan& plan, EffectSet known) {
  for (const Reason& reason : plan.why) {
    if (known.has(reason.effect)) continue;
    throw Error((reason.prim.empty() ? "render settings" : reason.prim) + ": found " +
                effect_name(reason.effect) + " (" + reason.why +
                "); expected none, since MSBVH_OMIT_EFFECTS left its code out of this build");
  }
}

std::vector<Reason> all_reasons(const Scene& scene, const PlanSettings& settings) {
  return plan_all(scene, settings, Planner(Collect::kAll)).why;
}

}  // namespace msbvh
