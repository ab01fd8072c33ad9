// Grids in a scene: surfaces where they are hit are those of their triangles, and light that bounces inside a
// closed one does not get out.
#include <memory>
#include <utility>
#include <vector>

#include "core/api/scene_trees.h"
#include "core/bvh/bvh.h"
#include "core/geometry/grid_triangles.h"
#include "core/shade/surface_hit.h"
#include "core/trace/tracer.h"
#include "tests/render/pictures.h"
#include "tests/support/cages.h"

namespace msbvh {
namespace {

using procedural::Random;

struct Case {
  const char* name;
  TrackForm form{};
  double place = 0.0;
  bool instanced = false;
};
const Case kCases[] = {{"still"},
                       {"still, far", {}, 1026.0},
                       {"2 keys", {1, 1}},
                       {"9 keys, far", {8, 1}, 1026.0},
                       {"resting instance", {}, 0.0, true},
                       {"instance of moving grids, far", {2, 1}, 1026.0, true}};

// A closed prism that turns, with bumps, and edges of rates that stitch.
GridMesh diced(const Case& c) {
  const Vec3d place{c.place, -c.place, c.place};
  const SubdivisionMesh cage =
      procedural::moved(procedural::prism_cage(5), c.form, procedural::rotation({1, 2, 0.5}, 0.7), place);
  DiceSettings settings;
  settings.edge_level = [](std::uint32_t a, std::uint32_t b) { return (a * b + a + b) % 4; };
  settings.displacement = procedural::bumps(0.15, 0.7, place);
  return dice(cage, settings);
}

Affine3f turned() { return {{0.6f, 0.8f, 0}, {-0.8f, 0.6f, 0}, {0, 0, 2}, {3, -1, 5}}; }

// Of a point of the grids' own space.
Vec3f in_world(const Case& c, const Vec3f& p) { return c.instanced ? turned().point(p) : p; }

std::shared_ptr<Scene> scene_with(const Case& c, GeometryId id) {
  auto scene = std::make_shared<Scene>();
  if (c.instanced) {
    scene->prototypes.push_back({"/prototype", {id}});
    scene->instances.push_back({"/instance", 0, 0, {turned()}, {}});
  } else {
    scene->world.push_back(id);
  }
  return scene;
}

std::shared_ptr<const Scene> scene_of_grids(const Case& c) {
  const auto scene = scene_with(c, {GeometryKind::kGridMesh, 0});
  Grids& grids = scene->grids.emplace_back();
  grids.shape = diced(c);
  Random random(5);
  grids.normals = {Interpolation::kVertex, 0, {}};
  grids.display_color = {Interpolation::kTriangle, 0, {}};
  const std::size_t points = value_count(Interpolation::kVertex, grids.shape);
  for (std::size_t i = 0; i < points; ++i) grids.normals.values.push_back(random.direction());
  for (std::size_t i = 0; i < grids.shape.grids.size(); ++i)
    grids.display_color.values.push_back(random.in_box({0, 0, 0}, {1, 1, 1}));
  return scene;
}

// The same as triangles, with the same values.
std::shared_ptr<const Scene> scene_of_triangles(const Case& c, const Grids& grids) {
  const auto scene = scene_with(c, mesh_id(0));
  Mesh& mesh = scene->meshes.emplace_back();
  mesh.shape = validated(triangles_of(grids.shape));
  mesh.normals = {Interpolation::kFaceVarying, 0, {}};
  mesh.display_color = {Interpolation::kTriangle, 0, {}};
  for (std::uint32_t id = 0; id < grids.shape.triangle_count(); ++id) {
    const GridTriangle t = grids.shape.triangle(id);
    const Grid& grid = grids.shape.grids[t.grid];
    std::size_t first = 0;
    for (std::uint32_t g = 0; g < t.grid; ++g) first += grids.shape.grids[g].points();
    for (const GridVertex& v : vertices_of(t))
      mesh.normals.values.push_back(grids.normals.values[first + v.row * grid.row_stride() + v.column]);
    mesh.display_color.values.push_back(grids.display_color.values[t.grid]);
  }
  return scene;
}

Ray inside(const Case& c, Random& random) {
  const float place = float(c.place);
  const Vec3f centre{place, -place, place};
  return {.org = in_world(c, centre + random.direction() * 0.1f),
          .dir = random.direction(),
          .time = random.uniform()};
}

// Towards a corner of quads.
Vec3f to_corner(const Case& c, const GridMesh& shape, const Vec3f& from, float time, Random& random) {
  const Grid& grid = shape.grids[std::size_t(random.uniform() * 0.999f * float(shape.grids.size()))];
  const auto place = [&](std::uint32_t quads) {
    return std::uint32_t(random.uniform() * 0.999f * float(quads + 1));
  };
  return in_world(c, shape.point(grid, place(grid.rows), place(grid.columns), time)) - from;
}

}  // namespace

TEST_CASE("a surface of grids is that of their triangles") {
  for (const Case& c : kCases) {
    CAPTURE(c.name);
    const auto scene = scene_of_grids(c), triangles = scene_of_triangles(c, scene->grids[0]);
    validate(scene->grids[0].shape);
    SceneTrees trees(scene, {}, nullptr);
    trees.verify();
    const SceneIndex index(*scene), of_triangles(*triangles);
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
      const Ray ray = inside(c, random);
      Hit hit;
      REQUIRE(trees.world().intersect(ray, hit));
      CHECK(hit.geometry == GeometryId{GeometryKind::kGridMesh, 0});
      Hit same = hit;
      same.geometry = mesh_id(0);
      const SurfaceHit found = surface_at(*scene, index.resolve(hit), hit, ray);
      const SurfaceHit expected = surface_at(*triangles, of_triangles.resolve(same), same, ray);
      CHECK(found.position == expected.position);
      CHECK(found.geometric_normal == expected.geometric_normal);
      CHECK(found.shading_normal == expected.shading_normal);
      CHECK(found.albedo == expected.albedo);
      CHECK(found.origin.before == expected.origin.before);
      CHECK(found.origin.beside_edge == expected.origin.beside_edge);
      CHECK(found.origin.need == expected.origin.need);
    }
  }
}

TEST_CASE("light that bounces inside closed displaced grids stays inside, as it does in their triangles") {
  for (const Case& c : kCases) {
    CAPTURE(c.name);
    const auto scene = scene_of_grids(c), triangles = scene_of_triangles(c, scene->grids[0]);
    SceneTrees trees(scene, {}, nullptr), trees_of_triangles(triangles, {}, nullptr);
    const SceneIndex index(*scene), index_of_triangles(*triangles);
    const Surroundings around{index, trees.world().bvh()};
    const Surroundings around_triangles{index_of_triangles, trees_of_triangles.world().bvh()};
    Random random(17);
    int escaped = 0, looked = 0, bounces = 0;
    for (int path = 0; path < 1500; ++path) {
      Ray ray = inside(c, random);
      for (int depth = 0; depth < 4; ++depth) {
        Hit hit;
        if (!trees.world().intersect(ray, hit)) {
          ++escaped;
          break;
        }
        SurfaceHit surface = surface_at(*scene, index.resolve(hit), hit, ray);
        RayOrigin same = surface.origin;
        ++bounces;
        looked += surface.origin.beside_edge;
        const bool clear = clear_origin(around, ray, surface.origin);
        CHECK(clear == clear_origin(around_triangles, ray, same));
        CHECK(surface.origin.before == same.before);
        if (!clear) break;
        Vec3f direction = random.uniform() < 0.5f
                              ? random.direction()
                              : to_corner(c, scene->grids[0].shape, surface.position, ray.time, random);
        if (dot(direction, surface.geometric_normal) < 0.0f) direction = -direction;
        ray = leave(surface, direction, ray.time);
      }
    }
    CHECK(escaped == 0);
    CHECK(looked > bounces / 20);  // so that neighbours in tiles have been looked at
  }
}

}  // namespace msbvh
