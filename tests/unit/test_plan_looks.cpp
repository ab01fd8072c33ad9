// Which scenes call for specular reflection and textures, and why.
#include <doctest/doctest.h>

#include "core/plan/effect_plan.h"
#include "core/scene/opacity.h"
#include "tests/unit/still_scene.h"

namespace msbvh {
namespace {

std::string why(const Scene& scene, Effect effect) {
  const EffectPlan plan = plan_effects(scene, {.max_bounces = 0});
  for (const Reason& reason : plan.why) {
    if (reason.effect == effect) return reason.prim + ": " + reason.why;
  }
  return "";
}

Scene scene_with(const Material& material) {
  Scene scene = still_scene();
  scene.materials = {material};
  scene.meshes[0].material = 0;
  scene.textures = {{.name = "wood.png", .tiles = {{0, 0, {"wood.png"}}}}};
  scene.primvar_names = {"tint", "mask"};
  return scene;
}

TEST_CASE("what is diffuse alone calls for neither") {
  CHECK(plan_effects(scene_with({.name = "/clay"}), {.max_bounces = 0}).set == EffectSet{});
}

TEST_CASE("specular: the first thing that shows such a material") {
  Material gold{.name = "/gold", .specular = true, .metallic = 1.0f, .roughness = 0.25f, .clearcoat = 0.5f};
  CHECK(why(scene_with(gold), Effect::kSpecular) ==
        "/still: roughness 0.25 of /gold, metallic 1, clearcoat 0.5");
  Scene parts = scene_with({.name = "/clay"});
  parts.materials.push_back(gold);
  CHECK(why(parts, Effect::kSpecular) == "");  // nothing is bound to it
  parts.meshes[0].triangle_materials = {1};
  CHECK(why(parts, Effect::kSpecular) == "/still: roughness 0.25 of /gold, metallic 1, clearcoat 0.5");
}

TEST_CASE("specular: an instance's material counts, that of what it overrides does not") {
  Scene scene = scene_with({.name = "/plastic", .specular = true});
  scene.materials.push_back({.name = "/clay"});
  scene.world.clear();
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/instances", 0, 0, std::vector<Affine3f>(2), {}}};
  scene.instances[0].materials = {1, 1};
  CHECK(why(scene, Effect::kSpecular) == "");
  scene.instances[0].materials = {1, 0};
  CHECK(why(scene, Effect::kSpecular) == "/instances: roughness 0.5 of /plastic");
}

TEST_CASE("textures: which input, from where, and how many others") {
  Material wood{.name = "/wood"};
  wood.texture_reads = {{.texture = 0}};
  wood.driven = {{SurfaceInput::kRoughness, DrivenInput::Source::kTexture, 0, 1, false}};
  CHECK(why(scene_with(wood), Effect::kTextures) == "/still: roughness of /wood from wood.png");
  wood.driven.push_back({SurfaceInput::kDiffuseColor, DrivenInput::Source::kPrimvar, 0, 0, false});
  CHECK(why(scene_with(wood), Effect::kTextures) == "/still: roughness of /wood from wood.png, and 1 other");
  Material tinted{.name = "/tinted"};
  tinted.driven = {{SurfaceInput::kDiffuseColor, DrivenInput::Source::kPrimvar, 0, 0, false}};
  CHECK(why(scene_with(tinted), Effect::kTextures) == "/still: diffuseColor of /tinted from primvars:tint");
}

TEST_CASE("textures: a normal that nothing drives is bent along coordinates") {
  Material bumped{.name = "/bumped", .normal = {1, 0, 1}};
  CHECK(why(scene_with(bumped), Effect::kTextures) == "");
  bumped.normal_coordinates = 1;
  CHECK(why(scene_with(bumped), Effect::kTextures) == "/still: normal of /bumped");
}

TEST_CASE("refraction: where it is asked for, what is transparent, and reflects") {
  const auto bends = [](const Material& material, bool asked) {
    return plan_effects(scene_with(material), {.max_bounces = 0, .refraction = asked})
        .set.has(Effect::kRefraction);
  };
  Material glass{.name = "/glass", .opacity = 0.5f, .specular = true, .transparent_reflects = true};
  CHECK_FALSE(bends(glass, false));
  CHECK(bends(glass, true));
  Material other = glass;
  other.opacity = 1.0f;
  CHECK_FALSE(bends(other, true));
  other.driven = {{SurfaceInput::kOpacity, DrivenInput::Source::kPrimvar, 1, 0, false}};
  CHECK(bends(other, true));
  other = glass;
  other.transparent_reflects = false;
  CHECK_FALSE(bends(other, true));
  other = glass;
  other.specular = false;
  CHECK_FALSE(bends(other, true));
  const EffectPlan plan = plan_effects(scene_with(glass), {.max_bounces = 0, .refraction = true});
  CHECK(plan.why.back().prim == "/still");
  CHECK(plan.why.back().why == "ior 1.5 of /glass");
}

TEST_CASE("fibre: curves that say so, whose light no other lobe scatters") {
  Scene scene = still_scene();
  scene.curves.resize(1);
  scene.curves[0].shape.name = "/hair";
  scene.curves[0].shape.vertex_count = 4;
  scene.curves[0].shape.vertices.resize(4);
  scene.curves[0].shape.spans = {0};
  scene.world = {mesh_id(0), curves_id(0)};
  CHECK(why(scene, Effect::kFibre) == "");
  scene.curves[0].fibre = true;
  CHECK(why(scene, Effect::kFibre) == "/hair: 1 spans of hair");
  CHECK(why(scene, Effect::kSpecular) == "/hair: light in hair");
}

TEST_CASE("opacity that is driven may be anything; an instance's own counts") {
  Material leaf{.name = "/leaf"};
  leaf.driven = {{SurfaceInput::kOpacity, DrivenInput::Source::kPrimvar, 1, 0, false}};
  CHECK(why(scene_with(leaf), Effect::kOpacity) == "/still: opacity down to 0");
  Scene scene = still_scene();
  scene.world.clear();
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/instances", 0, 0, std::vector<Affine3f>(2), {}}};
  CHECK(why(scene, Effect::kOpacity) == "");
  scene.instances[0].display_opacity = {1.0f, 0.75f};
  CHECK(why(scene, Effect::kOpacity) == "/instances: opacity down to 0.75");
}

}  // namespace
}  // namespace msbvh
