// The promises on the scenes that are measured (bench/scene_classes.h): zero leaks, zero bound violations and
// zero mismatches beyond ties, on every class at every key count, offset, instruction set and builder, for
// rays one by one and many at once. The oracle judges every ray; but of a closed scene, which has no way out,
// a ray from inside that hits nothing is a leak without asking.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/ray_sets.h"
#include "bench/scene_classes.h"
#include "bench/trees.h"
#include "core/bvh/verify.h"
#include "tests/property/support.h"
#include "tests/support/soak.h"

using namespace msbvh;
using namespace msbvh::bench;

namespace {

struct Extent {
  std::uint32_t triangles;  // about so many, of open scenes
  std::uint32_t closed;     // and of closed ones, which are not until their walls have corners
  std::size_t rays;         // of each kind and tree, and as many in bundles; the oracle judges all of them
  std::size_t inside_rays;  // of closed scenes
  std::size_t instances;    // of each prototype, at most
  std::size_t slices;       // of time-split trees whose bounds are proved: each takes as long as a tree
  std::vector<std::uint32_t> segments;
  std::size_t stride = 1;  // of the pairs of offset and builder at all key counts, one in so many
};

void move(GridMesh& mesh, const Vec3d& offset) {
  for (const Grid& grid : mesh.grids) {
    for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) {
      float* values = mesh.values.data() + (mesh.control_values(grid, c) - mesh.values.data());
      for (int axis = 0; axis < 3; ++axis) {
        for (std::uint32_t p = 0; p < grid.points(); ++p, ++values)
          *values = static_cast<float>(double(*values) + offset[axis]);
      }
    }
  }
}

// The scene somewhere else: what is in the world, and the camera. Rounded to where floats are there.
BenchScene at(const BenchScene& made, const Vec3d& offset, std::size_t instances) {
  auto scene = std::make_shared<Scene>(*made.scene);
  const auto moved = [&](const Vec3f& p) { return Vec3f(Vec3d(p) + offset); };
  for (const GeometryId i : scene->world) {
    if (i.is(GeometryKind::kTriangleMesh)) {
      TriangleMesh& mesh = scene->meshes[i.index()].shape;
      for (std::size_t p = 0; p < mesh.position_count(); ++p) mesh.positions[p] = moved(mesh.positions[p]);
    } else if (i.is(GeometryKind::kGridMesh)) {
      move(scene->grids[i.index()].shape, offset);
    } else if (i.is(GeometryKind::kCurves)) {
      for (RoundVertex& v : scene->curves[i.index()].shape.vertices) v.p = moved(v.p);
    } else {
      for (RoundVertex& v : scene->points[i.index()].shape.vertices) v.p = moved(v.p);
    }
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

// Rays that a tree is asked, and what the oracle has found right: the closest hit of each, and whether it
// hits anything. The oracle tests every triangle: an answer that another instruction set has given, to the
// bit, it is not asked about again.
class JudgedRays {
 public:
  JudgedRays(const Bvh& world, std::vector<Ray> rays)
      : world_(world), rays_(std::move(rays)), right_hits_(rays_.size()), right_occluded_(rays_.size()) {}

  std::size_t count() const { return rays_.size(); }
  // How many rays have a wrong answer. Many at once are asked as well, and answer as one by one.
  std::size_t count_wrong(const Tracer& tracer) {
    property::check_as_one_by_one(tracer, rays_);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      Hit hit;
      const bool found = tracer.intersect(rays_[i], hit);
      const bool right = is_right(i, found ? std::optional(hit) : std::nullopt);
      wrong += !(is_right(i, tracer.occluded(rays_[i])) && right);
    }
    return wrong;
  }

 private:
  bool is_right(std::size_t i, const std::optional<Hit>& hit) {
    if (std::ranges::count(right_hits_[i], hit) > 0) return true;
    if (judge_intersection(world_, rays_[i], hit)) return false;
    right_hits_[i].push_back(hit);
    return true;
  }
  bool is_right(std::size_t i, bool occluded) {
    if (right_occluded_[i] == occluded) return true;
    if (judge_occlusion(world_, rays_[i], occluded)) return false;
    right_occluded_[i] = occluded;
    return true;
  }

  const Bvh& world_;
  const std::vector<Ray> rays_;
  std::vector<std::vector<std::optional<Hit>>> right_hits_;  // a ray's, by any instruction set
  std::vector<std::optional<bool>> right_occluded_;
};

// Camera rays or random ones, and as many in bundles.
std::vector<Ray> rays_of(RayKind kind, const BenchScene& scene, const Trees& trees, std::size_t count) {
  std::vector<Ray> rays = make_rays(kind, *scene.scene, trees.bounds(), Tracer(trees.world()), count, 3);
  const std::vector<Ray> bundles = property::bundles_of(rays);
  rays.insert(rays.end(), bundles.begin(), bundles.end());
  return rays;
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
  JudgedRays primary(world, rays_of(RayKind::kPrimary, scene, trees, extent.rays));
  JudgedRays random(world, rays_of(RayKind::kRandom, scene, trees, extent.rays));
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(std::string(instruction_set_name(set)));
    const Tracer tracer(world, set);
    CHECK(primary.count_wrong(tracer) == 0);
    CHECK(random.count_wrong(tracer) == 0);
    if (scene.interior.radius > 0.0f)
      CHECK(count_leaks(tracer, inside_rays(scene.interior, extent.inside_rays, 5)) == 0);
  }
}

void check_class(const SceneClass& kind, const Extent& extent) {
  CAPTURE(std::string(kind.name));
  std::size_t pair = 0;
  for (const std::uint32_t segments : extent.segments) {
    CAPTURE(segments);
    const TrackForm form{segments, segments == 0 ? 1 : kind.forms.front().degree};
    const bool closed = kind.make(64, form, 1).interior.radius > 0.0f;
    BenchScene made = kind.make(closed ? extent.closed : extent.triangles, form, 1);
    Extent of_class = extent;
    if (!made.scene->curves.empty()) {  // a span takes the oracle as long as a thousand triangles
      if (segments != 0 && segments != 1 && segments != 8 && segments != 128) continue;
      made = kind.make(extent.triangles / 8, form, 1);
      of_class.rays /= 4;
    }
    for (const double offset : {0.0, 1e3, 1e6}) {
      CAPTURE(offset);
      const BenchScene scene = at(made, {offset, -offset, offset}, extent.instances);
      for (const BuilderName& builder : kBuilders) {
        if (pair++ % extent.stride != 0) continue;
        CAPTURE(std::string(builder.name));
        check_scene(scene, builder.builder, of_class);
      }
    }
  }
}

}  // namespace

TEST_CASE("every scene class holds the promises at 2, 9 and 129 keys") {
  for (const SceneClass& kind : scene_classes()) check_class(kind, {200, 1000, 32, 200, 6, 8, {1, 8, 128}});
}

TEST_SUITE("slow") {
  TEST_CASE("soak: every scene class holds the promises at every key count") {
    const std::size_t rays = test::soak_count(4, 40);
    const std::size_t stride =
        test::soak_count(23, 1);  // shares no factor with three offsets or the builders
    for (const SceneClass& kind : scene_classes())
      check_class(kind, {500, 2000, rays, 4'000, 25, 128, {0, 1, 2, 4, 8, 16, 32, 64, 128}, stride});
  }
}
