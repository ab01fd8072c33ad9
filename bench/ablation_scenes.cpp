#include "bench/ablation_scenes.h"

#include "bench/ablation_texture.h"
#include "bench/scene_makers.h"
#include "core/base/error.h"
#include "core/plan/effect_plan.h"

namespace msbvh::bench {
namespace {

constexpr std::uint32_t kSeed = 1;
constexpr std::uint32_t kBounces = 2;
constexpr TrackForm kStill{0, 1};

class Maker {
 public:
  Maker(EffectSet effects, std::uint32_t triangles) : effects_(effects), triangles_(triangles) {}

  Scene make() {
    scene_ = *twist(triangles_, form(), kSeed).scene;
    if (on(Effect::kOpacity)) scene_.meshes[0].display_opacity.values = {0.5f};
    if (on(Effect::kInstances)) instance();
    if (on(Effect::kTimeRemaps)) {
      for (Prototype& prototype : scene_.prototypes)
        prototype.time_remap.pieces = {{0.0f, 0.0f, 0.5f, true}, {0.3f, 0.5f, 1.0f, true}};
    }
    if (on(Effect::kSpecular) || on(Effect::kTextures)) add_material();
    if (on(Effect::kRefraction)) scene_.materials[0].transparent_reflects = true;
    add_geometry();
    light();
    set_camera();
    return std::move(scene_);
  }

 private:
  bool on(Effect effect) const { return effects_.has(effect); }
  TrackForm form() const {
    if (on(Effect::kPolynomialMotion)) return {1, 2};
    return on(Effect::kDeformingKeys) ? TrackForm{1, 1} : kStill;
  }
  // The camera's axes, looking a little past its target by `aside`.
  Affine3f facing(float aside) const {
    Affine3f axes = scene_.camera.world_from_camera[0];
    axes.z = normalize(axes.z + axes.x * (0.5f + aside));
    axes.t = {};
    return axes;
  }

  // What the world shows becomes the one instance of a prototype.
  void instance() {
    scene_.prototypes = {{"prototype", std::move(scene_.world)}};
    scene_.world.clear();
    InstanceSet set{.name = "instances", .world_from_prototype = {Affine3f{}}, .display_color = {}};
    if (on(Effect::kMovingInstances)) {
      set.segments = 1;
      set.world_from_prototype.push_back({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.05f, 0.02f, 0.0f}});
    }
    scene_.instances = {std::move(set)};
  }

  // Plastic, or what is diffuse with an image for a colour, read where a primvar says.
  void add_material() {
    Material material{
        .name = "material", .diffuse_color = {0.5f, 0.4f, 0.3f}, .specular = on(Effect::kSpecular)};
    material.opacity_from_display_opacity = on(Effect::kOpacity);
    Mesh& mesh = scene_.meshes[0];
    mesh.material = 0;
    if (on(Effect::kTextures)) add_texture(mesh, material);
    scene_.materials = {material};
  }

  void add_texture(Mesh& mesh, Material& material) {
    scene_.primvar_names = {"st"};
    Primvar<Vec3f> coordinates{Interpolation::kVertex, 0, {}};
    const Vec3f* points = mesh.shape.control_positions(0);
    coordinates.values.assign(points, points + mesh.shape.vertex_count);
    mesh.primvars = {{0, std::move(coordinates)}};
    scene_.textures = {{.name = "scattered",
                        .tiles = {{0, 0, {texture_file()}}},
                        .wrap_s = TextureWrap::kRepeat,
                        .wrap_t = TextureWrap::kRepeat,
                        .color_space = "auto"}};
    material.texture_reads = {{.texture = 0, .coordinates = 0}};
    material.driven = {{SurfaceInput::kDiffuseColor, DrivenInput::Source::kTexture, 0, 0, false}};
  }

  void add_geometry() {
    if (on(Effect::kSubdivision)) {
      Mesh mesh = subdiv(triangles_ / 4, kStill, kSeed).scene->meshes[0];
      mesh.cage_faces = 240;  // of the torus
      scene_.world.push_back(mesh_id(static_cast<std::uint32_t>(scene_.meshes.size())));
      scene_.meshes.push_back(std::move(mesh));
    }
    if (on(Effect::kDisplacement)) {
      scene_.grids = displaced(triangles_ / 4, kStill, kSeed).scene->grids;
      scene_.grids[0].displaced_by = 0.02f;
      scene_.world.push_back(grids_id(0));
    }
    if (on(Effect::kCurves)) {
      scene_.curves = hair(triangles_ / 4, kStill, kSeed).scene->curves;
      scene_.curves[0].fibre = on(Effect::kFibre);
      scene_.world.push_back(curves_id(0));
    }
    if (on(Effect::kPoints)) {
      scene_.points = particles(triangles_ / 4, kStill, kSeed).scene->points;
      scene_.world.push_back(points_id(0));
    }
  }

  void light() {
    Light sun;
    sun.name = "sun";
    sun.angle_degrees = on(Effect::kAreaLights) ? 2.0f : 0.0f;
    sun.world_from_light = {facing(0.0f)};
    if (on(Effect::kMovingLights)) {
      sun.segments = 1;
      sun.world_from_light.push_back(facing(0.1f));
    }
    if (on(Effect::kLightControls)) sun.diffuse = 0.5f;
    scene_.lights = {sun};
    Light dome;
    dome.name = "dome";
    dome.kind = LightKind::kDome;
    dome.radiance = {0.3f, 0.4f, 0.5f};
    if (on(Effect::kDomeLight)) scene_.lights.push_back(dome);
    if (!on(Effect::kImageDome)) return;
    dome.name = "sky";
    dome.world_from_light = {Affine3f{}};
    dome.image = sky();
    scene_.lights.push_back(dome);
  }

  // Brighter towards its top.
  static std::shared_ptr<const LightImage> sky() {
    constexpr std::uint32_t kWidth = 16, kHeight = 8;
    std::vector<Vec3f> texels;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i)
      texels.push_back(Vec3f{0.5f, 0.7f, 1.0f} * (1.0f / static_cast<float>(1 + i / kWidth)));
    return light_image("sky", ImageMap::kLatlong, kWidth, kHeight, std::move(texels));
  }

  void set_camera() {
    Camera& camera = scene_.camera;
    if (on(Effect::kCameraMotion)) {
      camera.segments = 1;
      camera.world_from_camera.push_back(camera.world_from_camera[0]);
      camera.world_from_camera[1].t += camera.world_from_camera[0].x * 0.02f;
      camera.window.push_back(camera.window[0]);
    }
    if (on(Effect::kLens)) camera.lens.assign(camera.window.size(), {0.02f, 4.0f});
  }

  const EffectSet effects_;
  const std::uint32_t triangles_;
  Scene scene_;
};

std::string names_of(EffectSet effects) {
  std::string names;
  for (std::size_t i = 0; i < kEffectCount; ++i) {
    if (effects.has(effect_at(i))) names.append(names.empty() ? "" : ", ").append(effect_name(effect_at(i)));
  }
  return names.empty() ? "no effects" : names;
}

}  // namespace

EffectSet needed_by(Effect effect) {
  switch (effect) {
    case Effect::kMovingInstances:
      return EffectSet{}.with(Effect::kInstances);
    case Effect::kImageDome:
      return EffectSet{}.with(Effect::kAreaLights);
    case Effect::kRefraction:
      return EffectSet{}.with(Effect::kSpecular).with(Effect::kOpacity);
    case Effect::kFibre:
      return EffectSet{}.with(Effect::kSpecular).with(Effect::kCurves);
    case Effect::kPolynomialMotion:
      return EffectSet{}.with(Effect::kDeformingKeys);
    case Effect::kTimeRemaps:
      return EffectSet{}.with(Effect::kInstances).with(Effect::kDeformingKeys);
    default:
      return {};
  }
}

CallingScene scene_calling_for(EffectSet effects, std::uint32_t triangles) {
  CallingScene made;
  made.scene = std::make_shared<const Scene>(Maker(effects, triangles).make());
  if (effects.has(Effect::kIndirectLight)) made.max_bounces = kBounces;
  for (std::size_t i = 0; effects.has(Effect::kAovs) && i <= std::size_t(kLastSurfaceAov); ++i)
    made.aovs.push_back(Aov(i));
  made.refraction = effects.has(Effect::kRefraction);
  const EffectSet found = plan_effects(*made.scene, {.max_bounces = made.max_bounces,
                                                     .aovs = made.aovs.empty() ? "" : "all",
                                                     .refraction = made.refraction})
                              .set;
  if (!(found == effects))
    throw Error("ablation scene: found a plan of " + names_of(found) + "; expected " + names_of(effects));
  return made;
}

}  // namespace msbvh::bench
