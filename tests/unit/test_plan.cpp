#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/plan/effect_bytes.h"
#include "core/plan/effect_plan.h"
#include "core/plan/known_effects.h"
#include "core/scene/opacity.h"
#include "tests/unit/still_scene.h"

namespace msbvh {
namespace {

Light light(const std::string& name, LightKind kind) {
  Light light;
  light.name = name;
  light.kind = kind;
  return light;
}

void check_only(const Scene& scene, Effect effect, const std::string& prim, const std::string& why) {
  const EffectPlan plan = plan_effects(scene, {.max_bounces = 0});
  CHECK(plan.set == EffectSet{}.with(effect));
  REQUIRE(plan.why.size() == 1);
  CHECK(plan.why[0].effect == effect);
  CHECK(plan.why[0].prim == prim);
  CHECK(plan.why[0].why == why);
}

TEST_CASE("a still, opaque scene calls for nothing") {
  CHECK(plan_effects(still_scene(), {.max_bounces = 0}).set == EffectSet{});
}

TEST_CASE("each effect comes with the first prim that asks for it") {
  Scene scene = still_scene();
  SUBCASE("deforming keys") {
    scene.meshes.push_back(triangle("/moving", 4));
    scene.meshes.push_back(triangle("/moving_too", 8));
    scene.world = {mesh_id(0), mesh_id(1), mesh_id(2)};
    check_only(scene, Effect::kDeformingKeys, "/moving", "4 segments");
  }
  SUBCASE("curves") {
    scene.curves.resize(2);
    scene.curves[1].shape.name = "/hair";
    scene.curves[1].shape.vertex_count = 7;
    scene.curves[1].shape.vertices.resize(7);
    scene.curves[1].shape.spans = {0, 3};
    scene.world = {mesh_id(0), curves_id(0), curves_id(1)};
    check_only(scene, Effect::kCurves, "/hair", "2 spans, flat, turned to the ray");
  }
  SUBCASE("points") {
    scene.points.resize(1);
    scene.points[0].shape.name = "/dust";
    scene.points[0].shape.point_count = 3;
    scene.points[0].shape.vertices.resize(3);
    scene.world = {mesh_id(0), points_id(0)};
    check_only(scene, Effect::kPoints, "/dust", "3 spheres");
  }
  SUBCASE("subdivision") {
    scene.meshes.push_back(triangle("/cage", 0));
    scene.meshes[1].cage_faces = 6;
    scene.world = {mesh_id(0), mesh_id(1)};
    check_only(scene, Effect::kSubdivision, "/cage", "limit surface of 6 faces, 1 triangles");
  }
  SUBCASE("instances") {
    scene.prototypes = {{"/prototype", {mesh_id(0)}}};
    scene.instances = {{"/instancer", 0, 0, std::vector<Affine3f>(12), {}}};
    check_only(scene, Effect::kInstances, "/instancer", "12 instances");
  }
  SUBCASE("own time remaps") {
    scene.prototypes = {{"/prototype", {mesh_id(0)}}};
    scene.instances = {{"/blinking", 0, 0, std::vector<Affine3f>(1), {}}};
    scene.instances[0].time_remap.pieces = {{0.0f, 0.0f, 0.5f, false}, {0.5f, 0.5f, 1.0f, true}};
    const EffectPlan plan = plan_effects(scene, {.max_bounces = 0});
    CHECK(plan.set == EffectSet{}.with(Effect::kInstances).with(Effect::kTimeRemaps));
    CHECK(plan.why.back().why == "2 pieces of the shutter");
  }
  SUBCASE("polynomial motion, beside the keys that carry it") {
    scene.meshes.push_back(triangle("/moving", 4));
    scene.meshes[1].shape.degree = 3;
    scene.meshes[1].shape.positions.resize(scene.meshes[1].shape.position_count() + TriangleMesh::kGuard);
    scene.world = {mesh_id(0), mesh_id(1)};
    const EffectPlan plan = plan_effects(scene, {.max_bounces = 0});
    CHECK(plan.set == EffectSet{}.with(Effect::kDeformingKeys).with(Effect::kPolynomialMotion));
    CHECK(plan.why.back().prim == "/moving");
    CHECK(plan.why.back().why == "4 segments, cubic");
  }
  SUBCASE("camera motion") {
    scene.camera.name = "/camera";
    scene.camera.segments = 1;
    check_only(scene, Effect::kCameraMotion, "/camera", "1 segment");
  }
  SUBCASE("lens") {
    scene.camera.name = "/camera";
    scene.camera.lens = {{0.25f, 5.0f}};
    check_only(scene, Effect::kLens, "/camera", "radius 0.25, focus at 5");
  }
  SUBCASE("opacity") {
    scene.meshes[0].display_opacity.values = {0.25f};
    check_only(scene, Effect::kOpacity, "/still", "opacity down to 0.25");
  }
  SUBCASE("area lights") {
    scene.lights = {light("/point", LightKind::kSphere), light("/sphere", LightKind::kSphere)};
    scene.lights[0].radius = 0.0f;
    scene.lights[1].radius = 1.5f;
    check_only(scene, Effect::kAreaLights, "/sphere", "radius 1.5");
  }
  SUBCASE("dome light") {
    scene.lights = {light("/dome", LightKind::kDome)};
    scene.lights[0].segments = 4;  // a constant dome looks the same from everywhere
    check_only(scene, Effect::kDomeLight, "/dome", "constant dome");
  }
}

TEST_CASE("light controls and image domes say what asks for them; neutral ones ask for nothing") {
  Scene scene = still_scene();
  scene.lights = {light("/point", LightKind::kSphere)};
  Light& point = scene.lights[0];
  point.radius = 0.0f;
  const EffectSet none{};
  CHECK(plan_effects(scene, {.max_bounces = 0}).set == none);
  SUBCASE("cone") {
    point.cone_angle_degrees = 30.0f;
    check_only(scene, Effect::kLightControls, "/point", "cone");
    point.kind = LightKind::kDistant;  // nothing shapes it
    point.angle_degrees = 0.0f;
    CHECK(plan_effects(scene, {.max_bounces = 0}).set == none);
  }
  SUBCASE("focus") {
    point.focus = 1.0f;
    check_only(scene, Effect::kLightControls, "/point", "focus");
  }
  SUBCASE("IES profile") {
    point.ies.profile = std::make_shared<const IesProfile>();
    check_only(scene, Effect::kLightControls, "/point", "IES profile");
  }
  SUBCASE("multipliers") {
    point.specular = 0.0f;
    check_only(scene, Effect::kLightControls, "/point", "diffuse or specular multiplier");
  }
  SUBCASE("shadow settings") {
    point.shadow.enabled = false;
    check_only(scene, Effect::kLightControls, "/point", "shadow settings");
  }
  SUBCASE("links") {
    point.lit_groups = {1, 1};
    point.shadow_groups = {1, 1};
    CHECK(plan_effects(scene, {.max_bounces = 0}).set == none);
    point.shadow_groups = {1, 0};
    check_only(scene, Effect::kLightControls, "/point", "shadow link");
    point.lit_groups = {0, 1};
    check_only(scene, Effect::kLightControls, "/point", "light link");
  }
  SUBCASE("image dome") {
    scene.lights = {light("/sky", LightKind::kDome)};
    scene.lights[0].image = light_image("sky", ImageMap::kLatlong, 2, 1, {{1, 1, 1}, {0, 0, 0}});
    const EffectPlan plan = plan_effects(scene, {.max_bounces = 0});
    CHECK(plan.set == EffectSet{}.with(Effect::kImageDome).with(Effect::kAreaLights));
    CHECK(plan.why.back().why == "textured dome, 2 x 1 texels");
    CHECK(effect_bytes(scene)[Effect::kImageDome] == 2 * 16 + 4);
  }
  SUBCASE("new kinds are area lights alone") {
    scene.lights = {light("/tube", LightKind::kCylinder)};
    check_only(scene, Effect::kAreaLights, "/tube", "cylinder of radius 0.5, length 1");
    scene.lights = {light("/disk", LightKind::kDisk)};
    check_only(scene, Effect::kAreaLights, "/disk", "disk of radius 0.5");
  }
}

TEST_CASE("a light whose values move is a moving light, a dome as well, and its largest size counts") {
  Scene scene = still_scene();
  scene.lights = {light("/dome", LightKind::kDome), light("/sphere", LightKind::kSphere)};
  for (Light& moving : scene.lights) {
    moving.segments = 1;
    moving.world_from_light.resize(2);
    moving.moving_values.resize(2);
  }
  scene.lights[1].moving_values[1].radius = 2.5f;
  const EffectPlan plan = plan_effects(scene, {.max_bounces = 0});
  REQUIRE(plan.why.size() == 3);
  CHECK(plan.why[0].effect == Effect::kMovingLights);
  CHECK(plan.why[0].prim == "/dome");
  CHECK(plan.why[1].why == "radius 2.5");
}

TEST_CASE("a closed lens asks for nothing; one that moves says so") {
  Scene scene = still_scene();
  scene.camera.lens = {{0.0f, 5.0f}};
  CHECK(plan_effects(scene, {.max_bounces = 0}).set == EffectSet{});
  scene.camera.segments = 1;
  scene.camera.lens = {{0.25f, 5.0f}, {0.25f, 8.0f}};
  CHECK(plan_effects(scene, {.max_bounces = 0}).why.back().why == "radius 0.25, focus at 5 to 8");
}

TEST_CASE("indirect light is asked for by a setting") {
  Scene scene = still_scene();
  scene.lights = {light("/camera", LightKind::kCamera)};
  const EffectPlan plan = plan_effects(scene, {.max_bounces = 2});
  REQUIRE(plan.why.size() == 1);
  CHECK(plan.why[0].effect == Effect::kIndirectLight);
  CHECK(plan.why[0].prim.empty());
  CHECK(plan.why[0].why == "up to 2 bounces");
}

TEST_CASE("an effect that the build leaves out is an error, if the scene asks for it") {
  Scene scene = still_scene();
  scene.meshes.push_back(triangle("/moving", 2));
  scene.world.push_back(mesh_id(1));
  const EffectPlan moving = plan_effects(scene, {.max_bounces = 0});
  const EffectSet all = kKnownEffects;
  expect_known(moving, all.without(Effect::kLens));
  CHECK_THROWS_WITH_AS(
      expect_known(moving, all.without(Effect::kDeformingKeys)),
      "/moving: found deforming keys (2 segments); expected none, since MSBVH_OMIT_EFFECTS left its "
      "code out of this build",
      Error);
  scene.lights = {light("/camera", LightKind::kCamera)};
  CHECK_THROWS_WITH_AS(
      expect_known(plan_effects(scene, {.max_bounces = 1}), all.without(Effect::kIndirectLight)),
      "render settings: found indirect light (up to 1 bounce); expected none, since "
      "MSBVH_OMIT_EFFECTS left its code out of this build",
      Error);
}

TEST_CASE("where nothing shines, bounces fold away; a surface that glows shines") {
  Scene scene = still_scene();
  scene.lights = {light("/black", LightKind::kRect), light("/dark", LightKind::kDome)};
  for (Light& black : scene.lights) black.radiance = {};
  CHECK(plan_effects(scene, {.max_bounces = 2}).set == EffectSet{});
  const auto bounces = [&] {
    return plan_effects(scene, {.max_bounces = 2}).set.has(Effect::kIndirectLight);
  };
  SUBCASE("by a colour") {
    scene.materials.resize(1);
    CHECK(plan_effects(scene, {.max_bounces = 2}).set == EffectSet{});
    scene.materials[0].emissive_color = {0, 0, 1};
    CHECK(bounces());
  }
  SUBCASE("by a primvar") {
    scene.materials.resize(1);
    scene.materials[0].emissive_from_display_color = true;
    CHECK(bounces());
  }
  SUBCASE("a light") {
    scene.lights.push_back(light("/camera", LightKind::kCamera));
    CHECK(bounces());
  }
}

TEST_CASE("a light that is black throughout asks for nothing; one that is lit at one key asks") {
  Scene scene = still_scene();
  scene.lights = {light("/blinks", LightKind::kSphere)};
  scene.lights[0].segments = 1;
  scene.lights[0].world_from_light.resize(2);
  scene.lights[0].moving_values.resize(2);
  for (LightValues& values : scene.lights[0].moving_values) values.radiance = {};
  CHECK(plan_effects(scene, {.max_bounces = 0}).set == EffectSet{});
  scene.lights[0].moving_values[1].radiance = {1, 1, 1};
  CHECK(plan_effects(scene, {.max_bounces = 0}).set ==
        EffectSet{}.with(Effect::kMovingLights).with(Effect::kAreaLights));
}

TEST_CASE("reasons stand in the order of the effects, once each") {
  Scene scene = still_scene();
  scene.meshes.push_back(triangle("/moving", 2));
  scene.prototypes = {{"/prototype", {mesh_id(1)}}};
  scene.instances = {{"/a", 0, 1, std::vector<Affine3f>(2), {}}, {"/b", 0, 4, std::vector<Affine3f>(5), {}}};
  scene.lights = {light("/camera", LightKind::kCamera)};
  const EffectPlan plan = plan_effects(scene, {.max_bounces = 1});
  REQUIRE(plan.why.size() == 4);
  CHECK(plan.why[0].effect == Effect::kDeformingKeys);
  CHECK(plan.why[1].effect == Effect::kInstances);
  CHECK(plan.why[2].effect == Effect::kMovingInstances);
  CHECK(plan.why[2].prim == "/a");
  CHECK(plan.why[3].effect == Effect::kIndirectLight);
}

TEST_CASE("what nobody sees asks for nothing") {
  Scene scene = still_scene();
  scene.meshes.push_back(triangle("/unused", 8));
  scene.prototypes = {{"/prototype", {mesh_id(1)}}};
  scene.instances = {{"/empty", 0, 2, {}, {}}};
  CHECK(plan_effects(scene, {.max_bounces = 0}).set == EffectSet{});
}

TEST_CASE("opacity follows UsdPreviewSurface") {
  Scene scene = still_scene();
  Mesh& mesh = scene.meshes[0];
  mesh.display_opacity.values = {0.25f};
  mesh.material = 0;
  scene.materials.resize(1);
  Material& material = scene.materials[0];
  SUBCASE("a material hides displayOpacity unless it reads it") {
    CHECK(least_opacity(scene, mesh) == 1.0f);
    material.opacity_from_display_opacity = true;
    CHECK(least_opacity(scene, mesh) == 0.25f);
    mesh.display_opacity.values.clear();
    material.opacity = 0.5f;
    CHECK(least_opacity(scene, mesh) == 0.5f);
  }
  SUBCASE("a threshold cuts out") {
    material.opacity = 0.6f;
    material.opacity_threshold = 0.5f;
    CHECK(least_opacity(scene, mesh) == 1.0f);
    material.opacity = 0.4f;
    CHECK(least_opacity(scene, mesh) == 0.0f);
  }
  SUBCASE("of materials that triangles or instances have") {
    scene.materials.resize(2);
    scene.materials[1].opacity = 0.5f;
    mesh.triangle_materials = {0};
    CHECK(least_opacity(scene, mesh) == 1.0f);
    mesh.triangle_materials = {1};
    CHECK(least_opacity(scene, mesh) == 0.5f);
    mesh.triangle_materials = {kNone};
    CHECK(least_opacity(scene, mesh) == 0.25f);
    const auto plans_opacity = [&] {
      return plan_effects(scene, {.max_bounces = 0}).set.has(Effect::kOpacity);
    };
    CHECK(plans_opacity());
    scene.world.clear();
    scene.prototypes = {{"/prototype", {mesh_id(0)}}};
    scene.instances = {{"/instances", 0, 0, std::vector<Affine3f>(2), {}}};
    scene.instances[0].materials = {0, 0};
    CHECK_FALSE(plans_opacity());
    scene.instances[0].materials = {0, 1};
    CHECK(plans_opacity());
  }
  SUBCASE("values outside [0, 1] are clamped") {
    CHECK(rendered_opacity(nullptr, 1.5f) == 1.0f);
    CHECK(rendered_opacity(nullptr, -1.0f) == 0.0f);
  }
}

TEST_CASE("every effect has a name") {
  for (std::uint32_t bit = 0; bit < kEffectCount; ++bit) {
    CHECK(std::string(effect_name(effect_at(bit))) != "unknown effect");
  }
  CHECK(std::string(effect_name(effect_at(kEffectCount))) == "unknown effect");
}

TEST_CASE("all reasons: each prim that asks, once an effect, in the scene's order; the first is the plan's") {
  Scene scene = still_scene();
  scene.meshes.push_back(triangle("/b", 2));
  scene.meshes.push_back(triangle("/a", 4));
  scene.meshes[1].display_opacity.values = {0.5f};
  scene.meshes[2].display_opacity.values = {0.25f};
  scene.world = {mesh_id(0), mesh_id(1), mesh_id(2)};
  scene.lights = {light("/camera", LightKind::kCamera)};
  const PlanSettings settings{.max_bounces = 1};
  const std::vector<Reason> all = all_reasons(scene, settings);
  REQUIRE(all.size() == 5);
  const char* const prims[] = {"/b", "/a", "/b", "/a", ""};
  for (std::size_t i = 0; i < all.size(); ++i) CHECK(all[i].prim == prims[i]);
  CHECK(all[1].why == "4 segments");
  CHECK(all[3].effect == Effect::kOpacity);
  const EffectPlan plan = plan_effects(scene, settings);
  REQUIRE(plan.why.size() == 3);
  CHECK(plan.why[1].why == all[2].why);
}

TEST_CASE("a prim with several instance sets that ask counts once") {
  Scene scene = still_scene();
  scene.prototypes = {{"/prototype", {mesh_id(0)}}};
  scene.instances = {{"/a", 0, 0, std::vector<Affine3f>(2), {}}, {"/a", 0, 0, std::vector<Affine3f>(3), {}}};
  CHECK(all_reasons(scene, {.max_bounces = 0}).size() == 1);
}

}  // namespace
}  // namespace msbvh
