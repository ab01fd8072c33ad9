// Every scene class that is measured (bench/scene_classes.h), as a compact tree: its invariants hold, and
// rays have the very hits that they have in the full tree, on each instruction set, which the oracle finds
// right.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
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

constexpr std::size_t kInstances = 12;  // of each prototype, at most: the oracle looks into all of them

struct Extent {
  std::uint32_t primitives;  // about so many; of curves an eighth
  std::size_t rays;          // of each kind, and as many in bundles
  std::size_t judged = 4;    // the oracle judges every so many of them
};

constexpr TrackForm kForms[] = {{0, 1}, {1, 1}, {8, 1}, {16, 1}, {1, 2}, {4, 2}, {1, 3}, {2, 3}};

std::shared_ptr<const Scene> with_fewer_instances(const Scene& made) {
  auto scene = std::make_shared<Scene>(made);
  for (InstanceSet& set : scene->instances) {
    const std::size_t kept = std::min(kInstances, instance_count(set)) * set.form().controls();
    set.world_from_prototype.resize(kept);
  }
  return scene;
}

void check_bounds(const Bvh& world) {
  CHECK_NOTHROW(verify(world));
  std::set<const Bvh*> objects;
  for (const Instance& instance : world.instances) objects.insert(instance.object.get());
  for (const Bvh* object : objects) CHECK_NOTHROW(verify(*object));
}

std::vector<Ray> rays_in(const Scene& scene, const Trees& trees, std::size_t count) {
  std::vector<Ray> rays;
  for (const RayKind kind : {RayKind::kPrimary, RayKind::kRandom}) {
    const std::vector<Ray> some = make_rays(kind, scene, trees.bounds(), Tracer(trees.world()), count, 3);
    rays.insert(rays.end(), some.begin(), some.end());
  }
  const std::vector<Ray> bundles = property::bundles_of(rays);
  rays.insert(rays.end(), bundles.begin(), bundles.end());
  return rays;
}

// One by one, and all at once; any hit, too. Returns the hits.
std::vector<Hit> check_same_hits(const Tracer& compact, const Tracer& full, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    CAPTURE(i);
    Hit expected;
    CHECK(compact.intersect(rays[i], hits[i]) == full.intersect(rays[i], expected));
    CHECK(hits[i] == expected);
    CHECK(compact.occluded(rays[i]) == full.occluded(rays[i]));
  }
  property::check_as_one_by_one(compact, rays);
  return hits;
}

// Returns how many hits there were.
std::size_t check_scene(const std::shared_ptr<const Scene>& scene, const BuildSettings& settings,
                        const Extent& extent) {
  BuildSettings compact_settings = settings;
  compact_settings.layout = TreeLayout::kCompact;
  const Trees full(scene, settings), compact(scene, compact_settings);
  check_bounds(compact.world());
  CHECK(compact.statistics().held_bytes() <= full.statistics().held_bytes());
  const std::vector<Ray> rays = rays_in(*scene, full, extent.rays);
  std::size_t found = 0;
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(std::string(instruction_set_name(set)));
    const std::vector<Hit> hits =
        check_same_hits(Tracer(compact.world(), set), Tracer(full.world(), set), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) found += hits[i].found();
    if (set != supported_instruction_sets().back()) continue;
    for (std::size_t i = 0; i < rays.size(); i += extent.judged) {
      const auto wrong = judge_intersection(compact.world(), rays[i],
                                            hits[i].found() ? std::optional(hits[i]) : std::nullopt);
      CHECK_MESSAGE(!wrong, wrong.value_or(""));
    }
  }
  return found;
}

void check_class(const SceneClass& kind, const Extent& extent) {
  CAPTURE(std::string(kind.name));
  std::size_t found = 0;
  for (const TrackForm& form : kForms) {
    CAPTURE(form.segments);
    CAPTURE(form.degree);
    const bool patches = !kind.make(64, {}, 1).scene->grids.empty();
    if (patches && form.degree > 1) continue;  // displacement takes linear tracks alone
    BenchScene made = kind.make(extent.primitives, form, 1);
    Extent of_class = extent;
    if (!made.scene->curves.empty()) {  // a span takes the oracle as long as a thousand triangles
      made = kind.make(extent.primitives / 8, form, 1);
      of_class.rays *= 4;
      of_class.judged *= 16;
    }
    found += check_scene(with_fewer_instances(*made.scene), {}, of_class);
  }
  CHECK(found > supported_instruction_sets().size() * (extent.rays / 12));  // the rays do test something
}

}  // namespace

TEST_CASE("compact trees of every scene class have the hits of full ones and of the oracle") {
  for (const SceneClass& kind : scene_classes()) check_class(kind, {1500, 96});
}

TEST_SUITE("slow") {
  TEST_CASE("soak: compact trees of every scene class, with many rays") {
    const std::size_t rays = test::soak_count(32, 1024);
    for (const SceneClass& kind : scene_classes()) check_class(kind, {4000, rays});
    test::soak_figure("compact trees", std::to_string(rays) + " rays of each kind in each scene class");
  }
}
