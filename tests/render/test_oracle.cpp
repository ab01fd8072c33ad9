// The batched renderer against the scalar path tracer: the same bits, whatever the scene calls for and
// however the work is cut up.
#include <atomic>
#include <random>

#include "core/api/scene_trees.h"
#include "core/integrate/render_tile.h"
#include "tests/render/pictures.h"
#include "tests/support/scalar_path_tracer.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kSize = 37;  // neither a multiple of the tile nor of a square of pixels

// What a scene may call for, in any combination.
struct Calls {
  bool instances, moving, opacity, lens, dome, materials, many_lights;
};

Mesh shards(std::mt19937& random, std::uint32_t segments) {
  std::uniform_real_distribution<float> place(0.0f, kSize), offset(-9.0f, 9.0f);
  std::vector<Vec3f> corners;
  Mesh mesh;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const Vec3f a{place(random), place(random), place(random)};
    for (int c = 0; c < 3; ++c) corners.push_back(a + Vec3f{offset(random), offset(random), offset(random)});
    mesh.shape.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.shape.name = "/shards";
  mesh.shape.segments = segments;
  mesh.shape.vertex_count = static_cast<std::uint32_t>(corners.size());
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    for (const Vec3f& p : corners)
      mesh.shape.positions.push_back(p + Vec3f{3.0f * float(key), float(key), 0});
  }
  mesh.display_color.values = {{0.7f, 0.6f, 0.5f}};
  return mesh;
}

void add_lights(Scene& scene, bool with_dome, bool with_many) {
  Light sun;
  sun.name = "/sun";
  sun.world_from_light = {Affine3f{}};
  sun.angle_degrees = 20.0f;
  Light panel;
  panel.name = "/panel";
  panel.kind = LightKind::kRect;
  panel.width = panel.height = 20.0f;
  panel.radiance = {9, 8, 7};
  panel.world_from_light = {translation({kSize / 2.0f, kSize / 2.0f, 60})};
  scene.lights = {sun, panel};
  for (int i = 0; with_many && i < 7; ++i) {
    Light lamp;
    lamp.name = "/lamp";
    lamp.kind = LightKind::kSphere;
    lamp.radius = i == 0 ? 0.0f : float(i);
    lamp.radiance = {5, 5, float(i)};
    lamp.world_from_light = {translation({6.0f * float(i), 20, 45})};
    scene.lights.push_back(lamp);
  }
  if (with_dome) scene.lights.push_back(dome({0.3f, 0.4f, 0.5f}));
}

void add_materials(Scene& scene) {
  scene.materials = {{.name = "/red", .diffuse_color = {0.8f, 0.1f, 0.1f}},
                     {.name = "/lamp", .emissive_color = {2, 1, 0}},
                     {.name = "/black", .diffuse_color = {}}};
  for (Mesh& mesh : scene.meshes) {
    for (std::size_t i = 0; i < mesh.shape.triangles.size(); ++i)
      mesh.triangle_materials.push_back(i % 4 == 3 ? kNone : static_cast<std::uint32_t>(i % 4));
  }
}

Scene called(const Calls& calls, std::uint32_t seed) {
  std::mt19937 random(seed);
  Scene scene;
  scene.camera = pixel_camera(kSize, kSize);
  add(scene, shards(random, calls.moving ? 4 : 0));
  if (calls.instances)
    add_instance(
        scene, shards(random, 0),
        calls.moving ? std::vector{translation({}), translation({5, 0, 0})} : std::vector{translation({})});
  if (calls.opacity) scene.meshes[0].display_opacity.values = {0.5f};
  if (calls.lens) {
    scene.camera.projection = Projection::kPerspective;
    scene.camera.world_from_camera = {translation({kSize / 2.0f, kSize / 2.0f, 100})};
    scene.camera.window = {{-0.25f, 0.25f, -0.25f, 0.25f}};
    scene.camera.near_clip = 1.0f;
    scene.camera.lens = {{2.0f, 80.0f}};
  }
  if (calls.materials) add_materials(scene);
  add_lights(scene, calls.dome, calls.many_lights);
  return scene;
}

Calls calls_of(std::uint32_t bits) {
  const auto bit = [&](int i) { return (bits >> i & 1) != 0; };
  return {bit(0), bit(1), bit(2), bit(3), bit(4), bit(5), bit(6)};
}

Image oracle_picture(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings) {
  const SceneTrees trees(scene, settings.build, nullptr);
  const EffectSet plan =
      plan_effects(*scene, {.max_bounces = settings.max_bounces, .refraction = settings.refraction}).set;
  const Bvh& world = trees.world().bvh();
  Box3f bounds;
  for (const Box3f& b : world.root_bounds) bounds.grow(b);
  std::optional<TextureCache> textures;
  if (!scene->textures.empty()) textures.emplace(scene->textures, settings.textures);
  Frame frame{SceneIndex(*scene),
              LightSampler(*scene, bounds),
              world,
              Tracer(world),
              settings.width,
              settings.height,
              settings.seed,
              settings.max_bounces,
              settings.show_domes,
              settings.sampling,
              textures ? &*textures : nullptr,
              choose_stages({}, settings.sampling, world),
              FilterSampler(settings.film.filter),
              ShutterSampler(settings.film.shutter_curve, settings.film.rolling)};
  frame.clamp_indirect = settings.clamp_indirect;
  frame.refraction = plan.has(Effect::kRefraction);
  frame.fibres = plan.has(Effect::kFibre);
  return scalar_picture(frame, settings.spp);
}

TEST_CASE("the picture is the scalar path tracer's to the bit, whatever the scene calls for") {
  for (std::uint32_t bits = 0; bits < 128; ++bits) {
    CAPTURE(bits);
    const auto scene = std::make_shared<const Scene>(called(calls_of(bits), bits));
    const RenderSettings settings{.width = kSize,
                                  .height = kSize,
                                  .spp = 5,
                                  .seed = bits,
                                  .max_bounces = bits % 4,
                                  .show_domes = bits % 3 != 0,
                                  .build = {}};
    CHECK(render(*scene, settings).rgba == oracle_picture(scene, settings).rgba);
  }
}

// Plastic, metal and coated lacquer on every second triangle, some of it driven by primvars.
void add_looks(Scene& scene, bool driven) {
  scene.materials = {{.name = "/plastic", .diffuse_color = {0.6f, 0.2f, 0.1f}, .specular = true},
                     {.name = "/gold",
                      .diffuse_color = {0.9f, 0.7f, 0.3f},
                      .specular = true,
                      .metallic = 1.0f,
                      .roughness = 0.2f},
                     {.name = "/lacquer",
                      .diffuse_color = {0.1f, 0.3f, 0.6f},
                      .specular = true,
                      .specular_workflow = true,
                      .specular_color = {0.1f, 0.2f, 0.3f},
                      .clearcoat = 0.8f}};
  scene.primvar_names = {"grain", "tint"};
  if (driven) {
    const auto primvar = DrivenInput::Source::kPrimvar;
    scene.materials[0].driven = {{SurfaceInput::kRoughness, primvar, 0, 0, false},
                                 {SurfaceInput::kDiffuseColor, primvar, 1, 0, false}};
    // A file that is not there: its fallback is drawn, read beside an opacity that no texture drives.
    scene.textures = {
        {.name = "none.png", .tiles = {{0, 0, {"none.png"}}}, .fallback = {0.3f, 0.2f, 0.6f, 1.0f}}};
    scene.materials[2].texture_reads = {{.texture = 0, .coordinates = 0}};
    scene.materials[2].driven = {{SurfaceInput::kOpacity, primvar, 0, 1, false},
                                 {SurfaceInput::kSpecularColor, DrivenInput::Source::kTexture, 0, 0, false}};
  }
  for (Mesh& mesh : scene.meshes) {
    const std::size_t triangles = mesh.shape.triangles.size();
    SurfacePrimvar grain{0, {Interpolation::kTriangle, 0, {}}};
    for (std::size_t i = 0; i < triangles; ++i) {
      mesh.triangle_materials.push_back(i % 4 == 3 ? kNone : static_cast<std::uint32_t>(i % 4));
      grain.primvar.values.push_back({float(i % 7) / 6.0f, float(i % 5) / 4.0f, 0.0f});
    }
    mesh.primvars = {grain, {1, {Interpolation::kConstant, 0, {{0.2f, 0.6f, 0.4f}}}}};
  }
}

// The shards shine, and so do those of an instance.
void add_mesh_lights(Scene& scene, std::uint32_t bits) {
  Light glow;
  glow.name = "/glow";
  glow.kind = LightKind::kMesh;
  glow.radiance = {2, 1, 3};
  glow.diffuse = 0.75f;
  if (bits & 8) glow.lit_groups = {1, 0, 1};
  if (bits & 16) glow.shadow.enabled = false;
  scene.lights.push_back(glow);
  if (scene.instances.empty()) return;
  glow.surface = {1, 0, 0};
  glow.shadow = {};
  glow.radiance = {0, 2, 1};
  scene.lights.push_back(glow);
}

TEST_CASE("what reflects otherwise than diffusely is the scalar path tracer's to the bit too") {
  for (std::uint32_t bits = 0; bits < 128; bits += 3) {
    CAPTURE(bits);
    Calls calls = calls_of(bits);
    const bool driven = calls.materials;
    calls.materials = false;
    Scene scene = called(calls, bits);
    add_looks(scene, driven);
    if (bits % 4 == 1) add_mesh_lights(scene, bits & 16);
    const auto shared = std::make_shared<const Scene>(std::move(scene));
    const RenderSettings settings{.width = kSize,
                                  .height = kSize,
                                  .spp = 5,
                                  .seed = bits,
                                  .max_bounces = bits % 4,
                                  .show_domes = bits % 5 != 0,
                                  .clamp_indirect = bits % 2 == 0 ? 0.0f : 0.05f,
                                  .build = {}};
    const std::vector<float> picture = render(*shared, settings).rgba;
    CHECK(picture == oracle_picture(shared, settings).rgba);
    CHECK(std::ranges::all_of(picture, [](float x) { return std::isfinite(x); }));
  }
}

// On both sides of everything, and so many that they are picked by the light tree.
void add_lamps(Scene& scene) {
  for (int i = 0; i < 6; ++i) {
    Light lamp;
    lamp.name = "/lamp" + std::to_string(i);
    lamp.kind = LightKind::kSphere;
    lamp.radius = 1.0f;
    lamp.radiance = {300.0f + 50.0f * float(i), 200, 100};
    lamp.world_from_light = {translation({6.0f * float(i), 12, i % 2 == 0 ? 45.0f : -45.0f})};
    scene.lights.push_back(lamp);
  }
}

// Transparent ones, and a normal that nothing drives.
void make_transparent(Scene& scene) {
  for (Material& material : scene.materials) material.transparent_reflects = true;
  scene.materials[0].opacity = 0.3f;
  scene.materials[0].normal = {0.3f, 0.2f, 0.9f};
  scene.materials[0].normal_coordinates = 2;
  scene.materials[1].opacity = 0.5f;
  scene.materials[1].metallic = 0.5f;
  scene.primvar_names.push_back("st");
  for (Mesh& mesh : scene.meshes) {
    SurfacePrimvar st{2, {Interpolation::kVertex, 0, {}}};
    for (std::uint32_t i = 0; i < mesh.shape.vertex_count; ++i)
      st.primvar.values.push_back({float(i % 3), float(i % 5), 0.0f});
    mesh.primvars.push_back(st);
  }
}

void add_hair(Scene& scene, CurveShape shape) {
  Curves hair;
  hair.shape.name = "/hair";
  hair.shape.shape = shape;
  hair.shape.vertex_count = 4;
  hair.shape.vertices = {{{2, 2, 40}, 4.0f}, {{20, 5, 42}, 4.0f}, {{5, 30, 38}, 3.0f}, {{33, 33, 41}, 1.0f}};
  hair.shape.spans = {0};
  hair.fibre = true;
  hair.display_color.values = {{0.8f, 0.5f, 0.2f}};
  scene.world.push_back(curves_id(0));
  scene.curves.push_back(hair);
}

TEST_CASE("so is what is transparent, bends light, is bumped, or scatters it as hair does") {
  for (std::uint32_t bits = 0; bits < 128; bits += 3) {
    CAPTURE(bits);
    Calls calls = calls_of(bits * 5 % 128);
    const bool driven = calls.materials, refraction = bits % 2 != 0;
    calls.materials = false;
    Scene scene = called(calls, bits);
    add_looks(scene, driven);
    if (bits % 4 != 2) make_transparent(scene);
    if (bits % 4 > 1) add_hair(scene, bits % 8 > 3 ? CurveShape::kTube : CurveShape::kRibbon);
    if (bits % 9 == 0) scene.lights[1].specular = 0.5f;
    if (bits % 9 == 3) add_mesh_lights(scene, bits & 16);
    if (bits % 12 == 3) add_lamps(scene);
    const auto shared = std::make_shared<const Scene>(std::move(scene));
    const RenderSettings settings{.width = kSize,
                                  .height = kSize,
                                  .spp = 5,
                                  .seed = bits,
                                  .max_bounces = bits % 5,
                                  .show_domes = bits % 5 != 0,
                                  .refraction = refraction,
                                  .build = {}};
    const std::vector<float> picture = render(*shared, settings).rgba;
    CHECK(picture == oracle_picture(shared, settings).rgba);
    CHECK(std::ranges::all_of(picture, [](float x) { return std::isfinite(x); }));
  }
}

TEST_CASE("so it is through every filter and shutter") {
  for (std::uint32_t bits = 0; bits < 16; ++bits) {
    CAPTURE(bits);
    const auto scene = std::make_shared<const Scene>(called(calls_of(bits * 37 % 128), bits));
    RenderSettings settings{.width = kSize, .height = kSize, .spp = 5, .seed = bits, .build = {}};
    settings.film.filter = {FilterShape(bits % 4), bits % 3 == 0 ? 1.0f : 0.75f + float(bits % 5) * 0.5f};
    if (bits & 1) settings.film.shutter_curve = bits & 2 ? triangle_curve() : trapezoid_curve();
    if (bits & 4) settings.film.rolling = {0.6f, 0.25f, 0.5f};
    CHECK(render(*scene, settings).rgba == oracle_picture(scene, settings).rgba);
  }
}

// Whatever a light may ask for beyond its kind.
void add_controls(Scene& scene, std::uint32_t bits) {
  const auto bit = [&](int i) { return (bits >> i & 1) != 0; };
  Light tube;
  tube.name = "/tube";
  tube.kind = LightKind::kCylinder;
  tube.radius = 3.0f;
  tube.length = 30.0f;
  tube.radiance = {4, 5, 6};
  tube.world_from_light = {translation({kSize / 2.0f, kSize / 2.0f, 50})};
  Light spot = tube;
  spot.name = "/spot";
  spot.kind = LightKind::kDisk;
  spot.radius = 9.0f;
  spot.cone_angle_degrees = 60.0f;
  spot.cone_softness = 0.5f;
  spot.focus = 2.0f;
  spot.diffuse = 0.75f;
  if (bit(0)) {
    Light sky = dome({0.5f, 0.6f, 0.7f});
    sky.name = "/sky";
    std::vector<Vec3f> texels;
    for (int i = 0; i < 12; ++i) texels.push_back({float(i % 5), 1, float(i % 3)});
    sky.image = light_image("sky", ImageMap::kLatlong, 4, 3, std::move(texels));
    sky.world_from_light = {Affine3f{}};
    if (bit(5)) sky.portals = {{9.0f, 9.0f, 0, {translation({kSize, kSize, 40})}}};
    if (bit(1)) {
      sky.segments = 1;
      sky.world_from_light = {Affine3f{}, {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}, {}}};
    }
    scene.lights.push_back(sky);
  }
  if (bit(2)) {
    spot.shadow = {true, {0.5f, 0, 0}, 20.0f, 8.0f, 2.0f};
    tube.shadow.enabled = false;
  }
  if (bit(3)) {
    scene.meshes[0].light_group = 1;
    for (InstanceSet& set : scene.instances) set.light_groups.assign(instance_count(set), 2);
    tube.lit_groups = {1, 0, 1};
    spot.lit_groups = {1, 1, 0};
    spot.shadow_groups = {1, 0, 1};
  }
  scene.lights.push_back(tube);
  scene.lights.push_back(spot);
}

TEST_CASE("the picture is the scalar path tracer's to the bit, whatever lights ask for") {
  for (std::uint32_t bits = 0; bits < 64; ++bits) {
    CAPTURE(bits);
    Calls calls = calls_of(bits * 7);
    calls.opacity = (bits >> 4 & 1) != 0;
    calls.instances = (bits >> 5 & 1) != 0;
    Scene made = called(calls, bits);
    add_controls(made, bits);
    if (bits % 3 == 0) add_mesh_lights(made, bits);
    const auto scene = std::make_shared<const Scene>(std::move(made));
    const RenderSettings settings{.width = kSize,
                                  .height = kSize,
                                  .spp = 3,
                                  .seed = bits,
                                  .max_bounces = bits % 3,
                                  .show_domes = bits % 5 != 0,
                                  .build = {}};
    CHECK(render(*scene, settings).rgba == oracle_picture(scene, settings).rgba);
  }
}

TEST_CASE("neither the batch's size nor the number of threads changes a bit") {
  const Scene scene = called({true, true, true, false, true, true, true}, 7);
  RenderSettings settings{.width = kSize, .height = kSize, .spp = 40, .max_bounces = 2, .build = {}};
  const std::vector<float> once = render(scene, settings).rgba;
  for (const std::uint32_t paths : {1u, 300u, 777u, 2048u}) {
    for (const std::uint32_t threads : {1u, 3u}) {
      settings.batch_paths = paths;
      settings.threads = threads;
      CAPTURE(paths);
      CAPTURE(threads);
      CHECK(render(scene, settings).rgba == once);
    }
  }
}

}  // namespace
}  // namespace msbvh
