// The promises on the scenes that are measured (bench/scene_classes.h): zero leaks, zero bound violations and
// zero mismatches beyond ties, on every class at every key count, offset, instruction set and builder, for
// rays one by one and many at once.
#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bench/ray_sets.h"
#include "bench/scene_classes.h"
#include "bench/trees.h"
#include "core/bvh/verify.h"
#include "tests/property/support.h"

using namespace msbvh;
using namespace msbvh::bench;

namespace {

struct Extent {
  std::uint32_t triangles;  // about so many, of open scenes
  std::uint32_t closed;     // and of closed ones, which are not until their walls have corners
  double oracle_tests;      // triangles that the oracle tests for each tree, kind of ray and instruction set
  std::size_t inside_rays;  // of closed scenes
  std::size_t instances;    // of each prototype, at most
  std::size_t slices;       // of time-split trees whose bounds are proved: each takes as long as a tree
  std::vector<std::uint32_t> segments;
};

constexpr std::size_t kRays = 64;  // of each kind

// The scene somewhere else: what is in the world, and the camera. Rounded to where floats are there.
BenchScene at(const BenchScene& made, const Vec3d& offset, std::size_t instances) {
  auto scene = std::make_shared<Scene>(*made.scene);
  for (const std::uint32_t i : scene->world_meshes) {
    TriangleMesh& mesh = scene->meshes[i].shape;
    for (std::size_t p = 0; p < mesh.position_count(); ++p)
      mesh.positions[p] = Vec3f(Vec3d(mesh.positions[p]) + offset);
  }
  for (InstanceSet& set : scene->instances) {
    const std::size_t kept = std::min(instances, instance_count(set)) * set.form().controls();
    set.world_from_prototype.resize(kept);
    for (Affine3f& map : set.world_from_prototype) map.t = Vec3f(Vec3d(map.t) + offset);
  }
  for (Affine3f& map : scene->camera.world_from_camera) map.t = Vec3f(Vec3d(map.t) + offset);
  return {std::move(scene), {Vec3f(Vec3d(made.interior.center) + offset), made.interior.radius}};
}

void check_bounds(const Bvh& world) {
  CHECK_NOTHROW(verify(world));
  std::set<const Bvh*> objects;
  for (const Instance& instance : world.instances) objects.insert(instance.object.get());
  for (const Bvh* object : objects) CHECK_NOTHROW(verify(*object));
}

double triangles_shown(const Bvh& bvh) {
  double sum = 0.0;
  for (const auto& mesh : bvh.meshes) sum += static_cast<double>(mesh->triangles.size());
  for (const Instance& instance : bvh.instances) sum += triangles_shown(*instance.object);
  return sum;
}

// The closest hit of each ray, and whether it hits anything, beside the oracle's: as many of the rays as it
// can afford, 2 at least.
std::size_t count_mismatches(const Bvh& world, const Tracer& tracer, const std::vector<Ray>& rays,
                             double tests) {
  std::size_t wrong = 0;
  const auto afforded = static_cast<std::size_t>(std::max(2.0, 0.5 * tests / triangles_shown(world)));
  const std::size_t stride = std::max<std::size_t>(1, rays.size() / afforded);
  for (std::size_t i = 0; i < rays.size(); i += stride) {
    const Ray& ray = rays[i];
    Hit hit;
    const bool found = tracer.intersect(ray, hit);
    wrong += judge_intersection(world, ray, found ? std::optional(hit) : std::nullopt).has_value();
    wrong += judge_occlusion(world, ray, tracer.occluded(ray)).has_value();
  }
  return wrong;
}

// Of rays from inside a closed scene: one by one, and all at once.
std::size_t count_leaks(const Tracer& tracer, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  tracer.intersect(rays, hits.data());
  std::size_t leaks = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    leaks += !hits[i].found();
    leaks += !tracer.intersect(rays[i], hit);
  }
  return leaks;
}

void check_scene(const BenchScene& scene, Builder builder, const Extent& extent) {
  BuildSettings settings;
  settings.builder = builder;
  const Trees trees(scene.scene, settings);
  const Bvh& world = trees.world();
  if (world.slice_roots.size() <= extent.slices) check_bounds(world);
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(std::string(instruction_set_name(set)));
    const Tracer tracer(world, set);
    for (const RayKind kind : {RayKind::kPrimary, RayKind::kRandom}) {
      CAPTURE(std::string(ray_kind_name(kind)));
      const std::vector<Ray> rays = make_rays(kind, *scene.scene, trees.bounds(), tracer, kRays, 3);
      CHECK(count_mismatches(world, tracer, rays, extent.oracle_tests) == 0);
      property::check_many(tracer, rays);
    }
    if (scene.interior.radius > 0.0f)
      CHECK(count_leaks(tracer, inside_rays(scene.interior, extent.inside_rays, 5)) == 0);
  }
}

void check_class(const SceneClass& kind, const Extent& extent) {
  CAPTURE(std::string(kind.name));
  for (const std::uint32_t segments : extent.segments) {
    CAPTURE(segments);
    const TrackForm form{segments, segments == 0 ? 1 : kind.forms.front().degree};
    const bool closed = kind.make(64, form, 1).interior.radius > 0.0f;
    const BenchScene made = kind.make(closed ? extent.closed : extent.triangles, form, 1);
    for (const double offset : {0.0, 1e3, 1e6}) {
      CAPTURE(offset);
      const BenchScene scene = at(made, {offset, -offset, offset}, extent.instances);
      for (const BuilderName& builder : kBuilders) {
        CAPTURE(std::string(builder.name));
        check_scene(scene, builder.builder, extent);
      }
    }
  }
}

}  // namespace

TEST_CASE("every scene class holds the promises at 2, 9 and 129 keys") {
  for (const SceneClass& kind : scene_classes()) check_class(kind, {200, 1000, 4e3, 200, 6, 8, {1, 8, 128}});
}

TEST_SUITE("slow") {
  TEST_CASE("every scene class holds the promises at every key count") {
    for (const SceneClass& kind : scene_classes())
      check_class(kind, {500, 2000, 2e4, 4'000, 25, 128, {0, 1, 2, 4, 8, 16, 32, 64, 128}});
  }
}
