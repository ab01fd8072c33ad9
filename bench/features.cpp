// Every feature of the acceleration structure, with and without it: one line of JSON a row.
// docs/make_features.py makes docs/features.md of them.
//
//   msbvh_bench_features [FACTOR [ROUNDS [FEATURE]]]
//
// FACTOR: of the scenes' sizes, 1 by default (20 to 60 thousand triangles, under a minute). FEATURE: rows of
// those whose name contains it. One thread; 2^15 rays at random times, at once where the row is not about
// that.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>

#include "bench/feature_rows.h"
#include "bench/feature_scenes.h"
#include "bench/limit_mesh.h"
#include "bench/trees.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/geometry/grid_triangles.h"
#include "tests/support/cages.h"

namespace {

using namespace msbvh;
using namespace msbvh::bench;

constexpr const char* kBuildPage = "docs/design/build.md";

BuildSettings builder(Builder chosen) {
  BuildSettings settings;
  settings.builder = chosen;
  return settings;
}

FeatureTree tree_of(std::shared_ptr<Accel> accel, double seconds) {
  const BvhStatistics& s = accel->statistics();
  const std::uint64_t bytes = s.node_bytes + s.leaf_bytes + s.vertex_bytes + s.grid_bytes;
  const Bvh& bvh = accel->bvh();
  return {std::move(accel), &bvh, bytes, seconds};
}

// The trees of a scene, as a renderer builds them.
FeatureSide trees(std::string name, const ScenePtr& scene, const BuildSettings& settings) {
  return {std::move(name), form_text(finest_form(*scene)), [=] {
            const Stopwatch watch;
            const auto trees = std::make_shared<Trees>(scene, settings);
            return FeatureTree{trees, &trees->world(), trees->bytes(), watch.seconds()};
          }};
}

std::shared_ptr<Accel> accel_of(const ScenePtr& scene) {
  auto accel = std::make_shared<Accel>();
  for (const GeometryId i : scene->world)
    accel->add_mesh(std::shared_ptr<const TriangleMesh>(scene, &scene->mesh(i).shape));
  return accel;
}

class Features {
 public:
  Features(double factor, int rounds, std::string filter)
      : factor_(factor), run_({.rounds = rounds}), filter_(std::move(filter)) {}

  void run() {
    spatial_splits();
    interpolated_bounds();
    fewest_keys();
    shutter_sah();
    temporal_splits();
    curves();
    instances();
    edge_rates();
    patches();
    pieces();
    refit();
    many_rays();
  }

 private:
  ScenePtr scene(const char* name, std::uint32_t triangles, const TrackForm& form) const {
    const double count = std::max(100.0, factor_ * triangles);
    return scene_class(name).make(static_cast<std::uint32_t>(count), form, run_.seed).scene;
  }
  bool wanted(const Feature& feature) const { return feature.name.find(filter_) != std::string::npos; }

  void print(const FeatureRow& row) const {
    if (!wanted(row.feature)) return;
    std::puts(measure(row, run_).c_str());
    std::fflush(stdout);
  }
  // The same scene by two settings.
  void compare(const Feature& feature, const char* name, const ScenePtr& scene,
               const std::pair<const char*, BuildSettings>& without,
               const std::pair<const char*, BuildSettings>& with) const {
    print({.feature = feature,
           .scene = scene,
           .scene_name = name,
           .without = trees(without.first, scene, without.second),
           .with = trees(with.first, scene, with.second)});
  }

  void spatial_splits() const {
    const Feature splits{"spatial splits", "triangles are cut where boxes of object splits overlap",
                         "paper, 3.1", "tests/property/test_hard_cases.cpp tests/property/test_oracle.cpp"};
    const Feature partial{"partial primitives at every key",
                          "a fragment is clipped at the centre and bounded at each key", "paper, 3.2",
                          "tests/property/test_oracle.cpp"};
    for (const char* name : {"hairball", "fences", "wheels"}) cut(splits, name, {1, 1});
    cut(splits, "hairball", {0, 1});
    cut(partial, "hairball", {8, 1});
    cut(partial, "wheels", {8, 1});
    cut(partial, "wheels", {32, 1});
  }

  // At the shutter's centre, as the paper has it, and by default, where sets that part are not cut.
  void cut(const Feature& feature, const char* name, const TrackForm& form) const {
    const ScenePtr moving = scene(name, 40000, form);
    BuildSettings without = builder(Builder::kMbvh), with = builder(Builder::kMsbvh);
    compare(feature, name, moving, {"mbvh", without}, {"msbvh", with});
    if (!form.moving()) return;
    without.sah_time = with.sah_time = SahTime::kCentre;
    compare(feature, name, moving, {"mbvh, SAH at the centre", without}, {"msbvh, SAH at the centre", with});
  }

  void interpolated_bounds() const {
    const Feature bounds{"boxes that move",
                         "boxes interpolated between keys; without: still ones around the whole motion",
                         "paper, 3.3", "tests/stability/test_watertight.cpp tests/property/test_oracle.cpp"};
    const Feature one_tree{"one tree for all segments",
                           "one topology for the shutter; without: a tree for each segment", kBuildPage,
                           "tests/property/test_baselines.cpp"};
    for (const char* name : {"wheels", "cloth", "hairball"}) {
      const ScenePtr moving = scene(name, 40000, {8, 1});
      for (const auto& with : {std::pair("mbvh", Builder::kMbvh), std::pair("msbvh", Builder::kMsbvh)}) {
        compare(bounds, name, moving, {"swept", builder(Builder::kSwept)},
                {with.first, builder(with.second)});
        compare(one_tree, name, moving, {"timesplit", builder(Builder::kTimeSplit)},
                {with.first, builder(with.second)});
      }
    }
  }

  void fewest_keys() const {
    const Feature feature{"fewest keys a node",
                          "a node has no more keys than bound its children about as well",
                          "core/bvh/box_track.h", "tests/property/test_fewest_keys.cpp"};
    BuildSettings all;
    all.fewest_keys = false;
    for (const auto& [name, segments] : {std::pair("twist", 8u), {"cloth", 8u}, {"wheels", 32u}}) {
      compare(feature, name, scene(name, 40000, {segments, 1}), {"all keys", all}, {"fewest", {}});
    }
  }

  void shutter_sah() const {
    const Feature feature{"SAH over the shutter, splits by velocity",
                          "boxes are weighed over the shutter where motion is incoherent", kBuildPage,
                          "tests/unit/test_topology.cpp tests/property/test_oracle.cpp"};
    BuildSettings centre;
    centre.sah_time = SahTime::kCentre;
    for (const auto& [name, segments] : {std::pair("debris", 1u), {"twist", 1u}, {"wheels", 8u}}) {
      compare(feature, name, scene(name, 40000, {segments, 1}), {"centre", centre}, {"shutter", {}});
    }
  }

  void temporal_splits() const {
    const Feature feature{"temporal splits",
                          "trees for equal slices of the shutter, over the same vertex tracks",
                          "core/bvh/time_split.h", "tests/property/test_time_slices.cpp"};
    const ScenePtr debris = scene("debris", 40000, {8, 1});
    BuildSettings whole;
    whole.time_slices = 1;
    for (const auto& [name, slices] :
         {std::pair("auto", 0u), {"2 slices", 2u}, {"4 slices", 4u}, {"8 slices", 8u}}) {
      BuildSettings sliced;
      sliced.time_slices = slices;
      compare(feature, "debris", debris, {"1 slice", whole}, {name, sliced});
    }
  }

  void curves() const {
    const Feature feature{"curves", "tracks on quadratic and cubic segments; without: linear keys as close",
                          "docs/design/motion.md", "tests/property/test_oracle.cpp"};
    for (const auto& [name, form] :
         {std::pair("ballistic", TrackForm{1, 2}), {"wheels", TrackForm{2, 3}}, {"twist", TrackForm{1, 2}}}) {
      const ScenePtr native = scene(name, 20000, form);
      print({.feature = feature,
             .scene = native,
             .scene_name = name,
             .without = trees("linear", with_linear_keys(native), {}),
             .with = trees(form.degree == 2 ? "quadratic" : "cubic", native, {})});
    }
  }

  void instances() const {
    const Feature feature{
        "animated instances",
        "moving instances of deforming objects; without: each a mesh of its own, on the product "
        "of both tracks, which is quadratic",
        "paper, on instances", "tests/property/test_instances.cpp"};
    const ScenePtr crowd = scene("crowd", 800, {1, 1});  // 125 times as many are seen
    if (!wanted(feature)) return;
    print({.feature = feature,
           .scene = crowd,
           .scene_name = "crowd",
           .without = trees("flattened", flattened(*crowd), {}),
           .with = trees("instanced", crowd, {})});
  }

  void edge_rates() const {
    const Feature feature{"rates by edge length",
                          "each edge of a subdivision cage is cut by its own length; without: all as finely "
                          "as the longest of them",
                          "docs/design/subdivision.md", "tests/unit/test_refined_mesh.cpp"};
    if (!wanted(feature)) return;
    for (const std::uint32_t segments : {1u, 8u}) {
      const auto cut = [&](EdgeRates rates) {
        procedural::Random random(run_.seed);
        const auto cut_scene = std::make_shared<Scene>();
        cut_scene->world = {mesh_id(0)};
        cut_scene->meshes.emplace_back().shape =
            limit_mesh(torus_cage({segments, 1}, random), static_cast<std::uint32_t>(factor_ * 40000), rates);
        return cut_scene;
      };
      const ScenePtr by_length = cut(EdgeRates::kByLength);
      print({.feature = feature,
             .scene = by_length,
             .scene_name = "subdiv",
             .without = trees("all as the longest", cut(EdgeRates::kFinest), {}),
             .with = trees("each by its length", by_length, {})});
    }
  }

  void patches() const {
    const Feature feature{"patches that are not tessellated",
                          "displaced subdivision patches as leaves; without: their triangles in the tree",
                          "paper, on displaced subdivision patches", "tests/property/test_grids.cpp"};
    if (!wanted(feature)) return;
    using namespace msbvh::procedural;
    const auto level = static_cast<std::uint32_t>(std::max(1.0, std::round(4.0 + 0.5 * std::log2(factor_))));
    for (const std::uint32_t segments : {1u, 8u}) {
      const SubdivisionMesh cage = moved(prism_cage(40), {segments, 1}, rotation({1, 2, 3}, 1.0));
      const auto grids =
          std::make_shared<GridMesh>(dice(cage, {.level = level, .displacement = bumps(0.03, 0.2)}));
      const std::string keys = form_text({segments, 1});
      const auto side = [&](const char* name, const std::function<void(Accel&)>& fill) {
        return FeatureSide{name, keys, [fill] {
                             auto accel = std::make_shared<Accel>();
                             fill(*accel);
                             const Stopwatch watch;
                             accel->commit();
                             return tree_of(std::move(accel), watch.seconds());
                           }};
      };
      print({.feature = feature,
             .scene = std::make_shared<Scene>(),
             .scene_name = "displaced prism",
             .without = side("triangles", [=](Accel& accel) { accel.add_mesh(triangles_of(*grids)); }),
             .with = side("patches", [=](Accel& accel) { accel.add_grids(*grids); })});
    }
  }

  void pieces() const {
    const Feature feature{"curves in pieces",
                          "spans as parts by parameter range where these are tighter; without: whole spans",
                          "paper, 3.1, for curves; docs/design/round.md", "tests/property/test_round.cpp"};
    for (const char* name : {"hair", "grass"}) {
      for (const TrackForm& form : {TrackForm{0, 1}, TrackForm{1, 1}, TrackForm{8, 1}})
        compare(feature, name, scene(name, 40000, form), {"whole", builder(Builder::kMbvh)}, {"pieces", {}});
    }
  }

  // The topology of this frame at the keys of the next one, against a build.
  void refit() const {
    const Feature feature{"refit", "the last frame's topology at this frame's keys; without: a build",
                          "docs/design/refit.md", "tests/property/test_refit.cpp"};
    for (const auto& [name, segments] : {std::pair("twist", 1u), {"hairball", 8u}, {"debris", 1u}}) {
      const ScenePtr first = scene(name, 40000, {segments, 1}), next = next_frame(*first);
      const auto refitted = [=] {
        BuildSettings settings;
        settings.keep_topology = true;
        settings.refit = Refit::kAlways;
        const auto previous = accel_of(first);
        previous->commit(settings);
        auto accel = accel_of(next);
        const Stopwatch watch;
        accel->commit_from(*previous, settings);
        return tree_of(std::move(accel), watch.seconds());
      };
      print({.feature = feature,
             .scene = next,
             .scene_name = name,
             .without = trees("built", next, {}),
             .with = {"refitted", form_text(finest_form(*next)), refitted}});
    }
  }

  void many_rays() const {
    const Feature closest{"many rays at once", "closest hits; without: one ray after another",
                          "docs/design/traversal.md", "tests/property/test_oracle.cpp"};
    const Feature any{"many rays at once, any hit", "occlusion; without: one ray after another",
                      "docs/design/traversal.md", "tests/property/test_oracle.cpp"};
    for (const std::uint32_t triangles : {40000u, 800000u}) {
      const ScenePtr twist = scene("twist", triangles, {1, 1});
      FeatureSide single = trees("one by one", twist, {});
      single.at_once = false;
      const FeatureSide many{"at once", single.keys, nullptr};
      const auto ask = [&](const Feature& feature, RayKind rays, bool any_hit) {
        print({feature, twist, "twist", rays, any_hit, single, many});
      };
      ask(closest, RayKind::kPrimary, false);
      ask(closest, RayKind::kRandom, false);
      ask(any, RayKind::kShadow, true);
      ask(any, RayKind::kRandom, true);
    }
  }

  const double factor_;
  const FeatureRun run_;
  const std::string filter_;  // of the features' names; empty: all
};

}  // namespace

int main(int argc, char** argv) {
  try {
    const double factor = argc > 1 ? std::atof(argv[1]) : 1.0;
    const int rounds = argc > 2 ? std::atoi(argv[2]) : 9;
    if (!(factor > 0.0) || rounds < 1)
      throw Error("expected a factor above 0 and a round or more; see the head of bench/features.cpp");
    Arena(1).execute([&] { Features(factor, rounds, argc > 3 ? argv[3] : "").run(); });
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "msbvh_bench_features: error: %s\n", error.what());
    return 1;
  }
}
