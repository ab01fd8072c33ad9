// What rays cost: counts are those of the frame's own rays, and everything that is counted is somebody's.
#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "bench/procedural.h"
#include "core/api/scene_trees.h"
#include "core/base/error.h"
#include "core/bvh/bvh.h"
#include "core/geometry/subdivision/dice.h"
#include "core/integrate/sampler.h"
#include "core/shade/camera.h"
#include "tests/render/pictures.h"
#include "tests/support/cages.h"

namespace msbvh {
namespace {
using namespace pictures;

constexpr std::uint32_t kEdge = 48;
constexpr std::uint32_t kSpp = 4;
constexpr std::uint64_t kEveryPath = std::uint64_t(kEdge) * kEdge * kSpp;
constexpr RayCostSettings kAll{.camera_samples = kEveryPath};

RenderSettings settings_of(std::uint32_t max_bounces) {
  return {.width = kEdge, .height = kEdge, .spp = kSpp, .max_bounces = max_bounces, .build = {}};
}

Affine3f placed(float scale, const Vec3f& t) { return {{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, t}; }

Mesh ball(const char* name, int rings, const Affine3f& map) {
  Mesh mesh;
  mesh.shape = procedural::sphere(rings);
  mesh = baked(std::move(mesh), {map});
  mesh.shape.name = name;
  return mesh;
}

// A ball of many triangles on the left and a card of two on the right.
Scene heavy_and_light() {
  Scene scene;
  scene.camera = pixel_camera(kEdge, kEdge);
  add(scene, ball("/heavy", 60, placed(9, {12, 24, 0})));
  Mesh card = polygon({rectangle(28, 8, 44, 40)});
  card.shape.name = "/light";
  add(scene, std::move(card));
  return scene;
}

RayCosts costs_of(const Scene& scene, const RenderSettings& settings, const RayCostSettings& asked = kAll) {
  Renderer renderer;
  renderer.commit(std::make_shared<const Scene>(scene), settings);
  return renderer.ray_costs(asked);
}

const PrimCosts& prim(const RayCosts& costs, const std::string& path) {
  const auto found = std::ranges::find(costs.prims, path, &PrimCosts::path);
  REQUIRE(found != costs.prims.end());
  return *found;
}

template <typename Value>
double sum(const RayCosts& costs, Value PrimCosts::*value) {
  return std::accumulate(costs.prims.begin(), costs.prims.end(), 0.0,
                         [&](double all, const PrimCosts& p) { return all + double(p.*value); });
}

// Nothing is lost, and nothing counted twice.
void check_sums(const RayCosts& costs) {
  CHECK(sum(costs, &PrimCosts::nodes) + costs.empty_nodes == doctest::Approx(double(costs.all.nodes)));
  CHECK(sum(costs, &PrimCosts::blocks) == double(costs.all.blocks));
  CHECK(sum(costs, &PrimCosts::primitives) == double(costs.all.primitives));
  CHECK(sum(costs, &PrimCosts::instances) == doctest::Approx(double(costs.all.instances)));
  CHECK(sum(costs, &PrimCosts::share) + costs.empty_share == doctest::Approx(1.0));
  CHECK(sum(costs, &PrimCosts::build_share) == doctest::Approx(1.0));
}

TEST_CASE("camera rays cost what they cost one by one") {
  const auto scene = std::make_shared<const Scene>(heavy_and_light());
  const SceneTrees trees(scene, {}, nullptr);
  const Tracer tracer(trees.world().bvh());
  const CameraRays rays(scene->camera);
  TraceCounts counts;
  for (std::uint32_t y = 0; y < kEdge; ++y) {
    for (std::uint32_t x = 0; x < kEdge; ++x) {
      const PixelSampler pixel(0, x, y);
      for (std::uint32_t s = 0; s < kSpp; ++s) {
        const Point2 at = pixel.position(s);
        Hit hit;
        tracer.intersect_counted(
            rays.ray((float(x) + at.x) / kEdge, (float(y) + at.y) / kEdge, pixel.time(s)), hit, counts);
      }
    }
  }
  const RayCosts costs = costs_of(*scene, settings_of(0));
  CHECK(costs.paths == kEveryPath);
  for (const TraceCounts& found : {costs.all, costs.camera}) {
    CHECK(found.rays == counts.rays);
    CHECK(found.nodes == counts.nodes);
    CHECK(found.blocks == counts.blocks);
    CHECK(found.primitives == counts.primitives);
    CHECK(found.instances == 0);
  }
  check_sums(costs);
}

// Bounces, shadows of several lights, and layers that are seen through.
Scene lit() {
  Scene scene = heavy_and_light();
  scene.meshes[1].display_opacity.values = {0.5f};
  add(scene, polygon({rectangle(0, 0, kEdge, kEdge, -20)}));
  Light lamp;
  lamp.name = "/lamp";
  lamp.kind = LightKind::kSphere;
  lamp.radiance = {9, 9, 9};
  lamp.world_from_light = {translation({24, 24, 40})};
  scene.lights = {dome({1, 1, 1}), lamp};
  return scene;
}

TEST_CASE("the rays are those that the frame traces, each once") {
  for (const bool opaque : {true, false}) {
    Scene scene = lit();
    if (opaque) scene.meshes[1].display_opacity.values = {1.0f};
    Renderer renderer;
    renderer.commit(std::make_shared<const Scene>(scene), settings_of(2));
    const RayCosts before = renderer.ray_costs(kAll);
    const Image image = renderer.render();
    const RayCosts after = renderer.ray_costs(kAll);
    CHECK(before.all.rays == renderer.statistics().rays.rays());
    CHECK(before.all.nodes == after.all.nodes);
    CHECK(image.rgba == render(scene, settings_of(2)).rgba);  // which was not touched
    CHECK(before.all.rays > 2 * before.camera.rays);
    CHECK((before.camera.rays == renderer.statistics().camera_rays) == opaque);
    check_sums(before);
  }
}

TEST_CASE("a part of the paths tells what all of them tell") {
  const RayCosts all = costs_of(lit(), settings_of(2));
  const RayCosts some = costs_of(lit(), settings_of(2), {.camera_samples = 600});
  CHECK(some.paths > 500);
  CHECK(some.paths < 700);
  const auto nodes = [](const RayCosts& c) { return double(c.all.nodes) / double(c.all.rays); };
  CHECK(nodes(some) == doctest::Approx(nodes(all)).epsilon(0.1));
  CHECK(prim(some, "/heavy").share == doctest::Approx(prim(all, "/heavy").share).epsilon(0.1));
}

TEST_CASE("many triangles cost more than two") {
  const RayCosts costs = costs_of(heavy_and_light(), settings_of(0));
  const PrimCosts &heavy = prim(costs, "/heavy"), &light = prim(costs, "/light");
  CHECK(costs.cost > double(costs.all.nodes + costs.all.blocks));
  CHECK(heavy.share > 1.3 * light.share);  // on half of its pixels
  CHECK(light.share > 0.0);
  CHECK(heavy.build_share > 0.99);
  CHECK(heavy.primitives > heavy.blocks);
  CHECK(light.primitives == 2 * light.blocks);
}

TEST_CASE("a prim that no ray gets to costs nothing, and costs a build all the same") {
  Scene scene = heavy_and_light();
  add(scene, ball("/outside", 60, placed(9, {1012, 24, 0})));
  const RayCosts costs = costs_of(scene, settings_of(0));
  CHECK(prim(costs, "/outside").share == 0.0);
  CHECK(prim(costs, "/outside").nodes == 0.0);
  CHECK(prim(costs, "/outside").build_share == doctest::Approx(0.5).epsilon(0.05));
  check_sums(costs);
}

TEST_CASE("without anything, nothing costs") {
  Scene scene;
  scene.camera = pixel_camera(kEdge, kEdge);
  const RayCosts costs = costs_of(scene, settings_of(1));
  CHECK(costs.all.rays == kEveryPath);
  CHECK(costs.all.nodes == 0);
  CHECK(costs.prims.empty());
  CHECK(costs.empty_share == 0.0);
}

TEST_CASE("rays into empty space are nobody's") {
  Scene scene = heavy_and_light();
  add(scene, ball("/far", 20, placed(2, {24, 24, -1000})));  // a root that is everywhere
  scene.camera.window = {{-2000.0f, 2000.0f, -2000.0f, 2000.0f}};
  const RayCosts costs = costs_of(scene, settings_of(0));
  CHECK(costs.empty_share > 0.5);
  check_sums(costs);
}

TEST_CASE("instances are the geometry's that they show") {
  Scene scene = heavy_and_light();
  const Mesh leaf = ball("/leaf", 40, placed(4, {}));
  scene.prototypes.push_back({"/tree", {mesh_id(add_mesh(scene, leaf))}});
  Mesh trunk = polygon({rectangle(-1, -8, 1, 8, 2)});
  trunk.shape.name = "/trunk";
  scene.prototypes[0].geometry.push_back(mesh_id(add_mesh(scene, std::move(trunk))));
  scene.instances.push_back({"/trees", 0, 0, {translation({12, 38, 30}), translation({36, 10, 30})}, {}});
  const RayCosts costs = costs_of(scene, settings_of(0));
  CHECK(costs.all.instances > 0);
  const double shown = prim(costs, "/leaf").instances + prim(costs, "/trunk").instances;
  CHECK(shown == doctest::Approx(double(costs.all.instances)));
  CHECK(prim(costs, "/leaf").share > prim(costs, "/trunk").share);
  CHECK(prim(costs, "/trunk").blocks > 0);
  CHECK(prim(costs, "/trunk").build_share > 0.0);
  check_sums(costs);
}

bool same(const PrimCosts& a, const PrimCosts& b) {
  return a.path == b.path && a.nodes == b.nodes && a.instances == b.instances && a.blocks == b.blocks &&
         a.primitives == b.primitives && a.share == b.share;
}

TEST_CASE("the same on any number of threads") {
  RenderSettings settings = settings_of(2);
  settings.threads = 1;
  const RayCosts one = costs_of(lit(), settings, {.camera_samples = 3000});
  for (const std::uint32_t threads : {2u, 7u}) {
    settings.threads = threads;
    const RayCosts several = costs_of(lit(), settings, {.camera_samples = 3000});
    CHECK(std::ranges::equal(one.prims, several.prims, same));
    CHECK(one.all.nodes == several.all.nodes);
    CHECK(one.camera.blocks == several.camera.blocks);
    CHECK(one.empty_nodes == several.empty_nodes);
  }
}

Curves bar() {
  Curves curves;
  curves.shape.name = "/bar";
  curves.shape.vertex_count = 4;
  for (int i = 0; i < 4; ++i) curves.shape.vertices.push_back({{8, 5.0f + 12.0f * float(i), 30}, 3.0f});
  curves.shape.spans = {0};
  return curves;
}

Points dots() {
  Points points;
  points.shape.name = "/dots";
  points.shape.point_count = 9;
  for (int i = 0; i < 9; ++i)
    points.shape.vertices.push_back({{24.0f + 3.0f * float(i % 3), 20.0f + 3.0f * float(i / 3), 30}, 1.5f});
  return points;
}

Grids patch() {
  Grids grids;
  SubdivisionMesh cage = procedural::prism_cage(5);
  for (Vec3f& p : cage.positions) p = p * 5.0f + Vec3f{38, 12, 30};
  DiceSettings settings;
  settings.edge_level = [](std::uint32_t, std::uint32_t) { return 3u; };
  grids.shape = dice(cage, settings);
  grids.shape.name = "/patch";
  return grids;
}

TEST_CASE("curves, points and patches have their shares") {
  Scene scene;
  scene.camera = pixel_camera(kEdge, kEdge);
  add(scene, polygon({rectangle(0, 0, kEdge, kEdge)}));
  scene.grids.push_back(patch());
  scene.curves.push_back(bar());
  scene.points.push_back(dots());
  scene.world.insert(scene.world.end(), {grids_id(0), curves_id(0), points_id(0)});
  const RayCosts costs = costs_of(scene, settings_of(0));
  REQUIRE(costs.prims.size() == 4);
  for (const PrimCosts& p : costs.prims) {
    CAPTURE(p.path);
    CHECK(p.share > 0.01);
    CHECK(p.blocks > 0);
    CHECK(p.primitives >= p.blocks);
    CHECK(p.build_share > 0.0);
  }
  CHECK(prim(costs, "/dots").geometry == points_id(0));
  check_sums(costs);
}

TEST_CASE("what cannot be counted is an error, and counting can be stopped") {
  Renderer renderer;
  CHECK_THROWS_AS(renderer.ray_costs({}), Error);
  renderer.commit(std::make_shared<const Scene>(lit()), settings_of(2));
  CHECK_THROWS_WITH_AS(renderer.ray_costs({.camera_samples = 0}),
                       "ray costs: camera_samples: found 0; expected at least 1", Error);
  CHECK_THROWS_AS(renderer.ray_costs(kAll, [](double) { return false; }), Cancelled);
  double last = 0.0;
  renderer.ray_costs(kAll, [&](double done) {
    CHECK(done > last);
    last = done;
    return true;
  });
  CHECK(last == 1.0);
}

}  // namespace
}  // namespace msbvh
