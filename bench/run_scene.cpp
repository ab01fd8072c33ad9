#include "bench/run_scene.h"

#include <algorithm>
#include <memory>

#include "bench/checks.h"
#include "bench/json_row.h"
#include "bench/peer_input.h"
#include "bench/sides.h"
#include "bench/timing.h"
#include "core/base/error.h"
#include "core/base/parallel.h"

namespace msbvh::bench {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
// A peer's linear keys stay within a tenth of a pixel of our curves where the scene is 960 pixels across.
constexpr double kPeerTolerance = 0.1 / 960.0;
// Hit distances that differ by more than this share of the scene's size count as different.
constexpr double kDistanceTolerance = 1e-4;
constexpr std::size_t kInsideRays = 1u << 17;
// Builds are repeated until so many seconds are spent on them.
constexpr double kBuildSeconds = 2.0;
// Rays are traced again until so many seconds are spent for each contestant, at least thrice.
constexpr double kTraceSeconds = 0.75;
// Rays whose nodes and quarters of triangles are more than this come in a smaller number, but not below
// kLeastRays.
constexpr double kUsualWork = 60.0;
constexpr std::size_t kLeastRays = 1u << 13;
// A mode that takes so many times as long as the side's best one in the first round is not measured again.
constexpr double kOutOfReach = 2.5;

std::vector<BuilderName> chosen_builders(const std::vector<std::string>& names) {
  std::vector<BuilderName> chosen;
  for (const BuilderName& known : kBuilders) {
    if (names.empty() ? !known.comparison : std::ranges::count(names, known.name) > 0)
      chosen.push_back(known);
  }
  if (chosen.empty())
    throw Error("bench: found no builder of the names given; expected some of those of --builder");
  return chosen;
}

Box3f bounds_of(const Scene& scene) {
  Box3f box;
  for (const GeometryId i : scene.world) {
    if (!i.is(GeometryKind::kTriangleMesh)) continue;
    const TriangleMesh& mesh = scene.mesh(i).shape;
    for (std::size_t p = 0; p < mesh.position_count(); ++p) box.grow(mesh.positions[p]);
  }
  for (const Grids& grids : scene.grids) {
    for (const GridPatch& patch : grids.shape.patches) box.grow(grids.shape.bounds(patch, 0));
  }
  for (const Curves& curves : scene.curves) {
    for (const RoundVertex& v : curves.shape.vertices) box.grow(v.p);
  }
  for (const Points& points : scene.points) {
    for (const RoundVertex& v : points.shape.vertices) box.grow(v.p);
  }
  for (const InstanceSet& set : scene.instances) {
    for (const Affine3f& map : set.world_from_prototype) box.grow(map.t);
  }
  return box;
}

// Triangles, those of patches among them, spans of curves and points.
std::uint64_t primitives_of(const BvhStatistics& tree) {
  return tree.triangles + 2 * tree.quads + tree.spans + tree.points;
}

class SceneRun {
 public:
  SceneRun(const BenchScene& scene, const RunSettings& settings) : scene_(scene), settings_(settings) {
    for (const BuilderName& builder : chosen_builders(settings.builders)) {
      for (const TreeLayout layout : settings.layouts)
        ours_.push_back(std::make_shared<OurSide>(scene.scene, builder, layout));
    }
    if (settings.peer) {
      fill_peer_input(*scene.scene, kPeerTolerance * length(Vec3d(bounds_of(*scene.scene).extent())), input_);
      for (const bool robust : settings.robust) {
        if (input_.missing.empty()) {
          peers_.push_back(std::make_shared<PeerSide>(*settings.peer, input_.scene, robust));
        }
      }
    }
    sides_.assign(ours_.begin(), ours_.end());
    sides_.insert(sides_.end(), peers_.begin(), peers_.end());
    for (std::size_t side = 0; side < sides_.size(); ++side) {
      first_.push_back(contestants_.size());
      for (std::size_t mode = 0; mode < sides_[side]->modes().size(); ++mode)
        contestants_.push_back({side, mode});
    }
  }

  std::vector<std::string> run() {
    for (const unsigned threads : settings_.threads) {
      Arena arena(threads);
      arena.execute([&] { build(threads); });
      if (threads == settings_.threads.front()) {
        count_leaks();
        make_all_rays();
      }
      for (const RaySet& set : ray_sets_) measure(arena, threads, set);
      for (const auto& side : sides_) side->drop();
    }
    return std::move(rows_);
  }

 private:
  // A side that is asked in one of its modes. Those of a side are neighbours, from first_[side] on.
  struct Contestant {
    std::size_t side, mode;
  };
  struct Measured {  // by contestant
    std::vector<std::vector<float>> t;
    std::vector<std::vector<double>> seconds;
  };
  struct RaySet {
    RayKind kind;
    std::vector<Ray> rays;
    std::vector<OracleCheck> oracle;  // by builder
    std::vector<TraceCounts> work;
  };

  void build(unsigned threads) {
    build_seconds_ =
        interleave(sides_.size(), settings_.build_repetitions, 1, kBuildSeconds, [&](std::size_t i) {
          settings_.tick();
          sides_[i]->build(threads);
        });
  }

  void count_leaks() {
    misses_.assign(sides_.size(), kNotMeasured);
    if (scene_.interior.radius <= 0.0f) return;
    const std::vector<Ray> rays = inside_rays(scene_.interior, kInsideRays, settings_.seed);
    for (std::size_t i = 0; i < sides_.size(); ++i)
      misses_[i] = static_cast<double>(count_misses(*sides_[i], rays));
  }

  void make_all_rays() {
    size_ = length(Vec3d(ours_[0]->trees().bounds().extent()));
    for (const RayKind kind : settings_.kinds) {
      settings_.tick();
      RaySet set{kind, rays_of(kind, affordable_rays(kind)), {}, {}};
      if (set.rays.empty()) continue;
      for (const auto& side : ours_) {
        settings_.tick();
        set.oracle.push_back(check_oracle(side->trees().world(), kind, set.rays, settings_.oracle_tests));
        set.work.push_back(count_work(side->trees().world(), kind, set.rays));
      }
      ray_sets_.push_back(std::move(set));
    }
  }

  std::vector<Ray> rays_of(RayKind kind, std::size_t count) const {
    const Trees& trees = ours_[0]->trees();
    return make_rays(kind, *scene_.scene, trees.bounds(), Tracer(trees.world()), count, settings_.seed);
  }

  // Fewer where a ray takes much work. By counts, not by the clock: the same seed traces the same rays.
  std::size_t affordable_rays(RayKind kind) const {
    const std::size_t most = settings_.rays, least = std::min(most, kLeastRays);
    const TraceCounts work = count_work(ours_[0]->trees().world(), kind, rays_of(kind, least));
    const double tests = static_cast<double>(work.nodes) + 0.25 * static_cast<double>(work.primitives);
    const double share = kUsualWork * static_cast<double>(work.rays) / std::max(1.0, tests);
    return std::clamp(static_cast<std::size_t>(share * static_cast<double>(most)), least, most);
  }

  void measure(Arena& arena, unsigned threads, const RaySet& set) {
    const std::size_t count = contestants_.size();
    Measured found{std::vector(count, std::vector<float>(set.rays.size())), {}};
    const auto trace = [&](std::size_t c) {
      trace_all(*sides_[contestants_[c].side], contestants_[c].mode, set.kind, found.t[c]);
    };
    for (const auto& side : sides_) side->prepare(set.rays);
    arena.execute([&] {
      found.seconds = interleave(count, 1, 1, 0.0, trace);  // warm
      const std::vector<std::size_t> racing = within_reach(found.seconds);
      const double limit = kTraceSeconds * static_cast<double>(racing.size());
      const auto measured = interleave(racing.size(), settings_.repetitions, 3, limit,
                                       [&](std::size_t r) { trace(racing[r]); });
      for (std::size_t r = 0; r < racing.size(); ++r) found.seconds[racing[r]] = measured[r];
    });
    settings_.tick();
    for (std::size_t i = 0; i < ours_.size(); ++i) {
      if (peers_.empty()) write(threads, arena.threads(), set, i, sides_.size(), found);
      for (std::size_t p = ours_.size(); p < sides_.size(); ++p) {
        write(threads, arena.threads(), set, i, p, found);
      }
    }
  }

  // Contestants that may be the best mode of their side; the figure of the others is that of the first round.
  std::vector<std::size_t> within_reach(const std::vector<std::vector<double>>& first) const {
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < contestants_.size(); ++c) {
      double best = first[c][0];
      for (const std::size_t other : modes_of(contestants_[c].side)) best = std::min(best, first[other][0]);
      if (first[c][0] <= kOutOfReach * best) found.push_back(c);
    }
    return found;
  }

  std::size_t ours_single(std::size_t i) const { return first_[i] + OurSide::kSingle; }
  std::size_t ours_many(std::size_t i) const { return first_[i] + OurSide::kMany; }
  // Contestants that are modes of side `p`.
  std::vector<std::size_t> modes_of(std::size_t p) const {
    std::vector<std::size_t> all;
    for (std::size_t c = 0; c < contestants_.size(); ++c) {
      if (contestants_[c].side == p) all.push_back(c);
    }
    return all;
  }

  // A row of our side `i` beside the peer's side `p`; p == sides_.size(): no peer.
  void write(unsigned threads, unsigned used, const RaySet& set, std::size_t i, std::size_t p,
             const Measured& found) {
    const BvhStatistics& tree = ours_[i]->trees().statistics();
    JsonRow row;
    row.add("scene", settings_.name);
    row.add("triangles", primitives_of(tree));
    row.add("instances", tree.instances);
    row.add("keys", key_count(most_segments()));
    row.add("degree", most_degree());
    row.add("rays", ray_kind_name(set.kind));
    row.add("builder", ours_[i]->builder.name);
    row.add("layout", name_of(ours_[i]->layout));
    row.add("threads", threads);
    row.add("threads_used", used);
    row.add("ray_count", set.rays.size());
    row.add("rounds", found.seconds[ours_many(i)].size());
    write_speed(row, set, i, found.seconds);
    write_peer_speed(row, set, i, p, found.seconds);
    write_build_time(row, i, p);
    write_sizes(row, i, p);
    const double rays = static_cast<double>(set.work[i].rays);
    row.add("nodes_per_ray", static_cast<double>(set.work[i].nodes) / rays);
    row.add("blocks_per_ray", static_cast<double>(set.work[i].blocks) / rays);
    row.add("tests_per_ray", static_cast<double>(set.work[i].primitives) / rays);
    row.add("sah", tree.sah_cost);
    const std::uint64_t whole = tree.triangles + tree.patches + tree.spans + tree.points + tree.instances;
    row.add("duplication",
            static_cast<double>(tree.references) / static_cast<double>(std::max<std::uint64_t>(1, whole)));
    row.add("misses", misses_[i]);
    row.add("peer_misses", p < sides_.size() ? misses_[p] : kNotMeasured);
    row.add("mismatches", set.oracle[i].wrong);
    row.add("oracle_rays", set.oracle[i].rays);
    row.add("mode_mismatches",
            count_differences(set.rays, found.t[ours_many(i)], found.t[ours_single(i)], 0.0));
    row.add("peer_mismatches", peer_mismatches(set, i, p, found.t));
    rows_.push_back(row.text());
  }

  // The most of any of the peer's modes.
  double peer_mismatches(const RaySet& set, std::size_t i, std::size_t p,
                         const std::vector<std::vector<float>>& t) const {
    if (p >= sides_.size() || input_.sampled) return kNotMeasured;
    std::size_t most = 0;
    for (const std::size_t c : modes_of(p)) {
      most = std::max(most, count_differences(set.rays, t[ours_many(i)], t[c], kDistanceTolerance * size_));
    }
    return static_cast<double>(most);
  }

  static double mrays(const RaySet& set, const std::vector<double>& seconds) {
    return 1e-6 * static_cast<double>(set.rays.size()) / spread_of(seconds).median;
  }

  static void write_spread(JsonRow& row, const std::string& name, const Spread& spread) {
    row.add(name.c_str(), spread.median);
    row.add((name + "_low").c_str(), spread.low);
    row.add((name + "_high").c_str(), spread.high);
  }

  void write_speed(JsonRow& row, const RaySet& set, std::size_t i,
                   const std::vector<std::vector<double>>& seconds) const {
    const double mega = 1e-6 * static_cast<double>(set.rays.size());
    const Spread many = spread_of(seconds[ours_many(i)]);
    write_spread(row, "mrays", {mega / many.median, mega / many.high, mega / many.low});
    row.add("single_mrays", mrays(set, seconds[ours_single(i)]));
  }

  // The peer in each of its modes, and our ratios: many at once to its best mode, one at a time to one at a
  // time.
  void write_peer_speed(JsonRow& row, const RaySet& set, std::size_t i, std::size_t p,
                        const std::vector<std::vector<double>>& seconds) const {
    const bool beside = p < sides_.size();
    row.add("robust", beside ? peers_[p - ours_.size()]->robust : true);
    if (!beside) {
      for (const char* key : {"peer_mrays", "ratio", "ratio_low", "ratio_high", "single_ratio"})
        row.add(key, kNotMeasured);
      row.add("peer_mode", "");
      return;
    }
    const std::vector<std::size_t> modes = modes_of(p);
    const std::size_t best =
        *std::ranges::max_element(modes, {}, [&](std::size_t c) { return mrays(set, seconds[c]); });
    for (const std::size_t c : modes) {
      row.add(("peer_" + mode_name(c) + "_mrays").c_str(), mrays(set, seconds[c]));
    }
    row.add("peer_mode", mode_name(best));
    row.add("peer_mrays", mrays(set, seconds[best]));
    write_spread(row, "ratio", speed_ratio(seconds[ours_many(i)], seconds[best]));
    row.add("single_ratio", speed_ratio(seconds[ours_single(i)], seconds[modes.front()]).median);
  }

  const std::string& mode_name(std::size_t c) const {
    return sides_[contestants_[c].side]->modes()[contestants_[c].mode];
  }

  void write_build_time(JsonRow& row, std::size_t i, std::size_t p) const {
    row.add("build_s", spread_of(build_seconds_[i]).median);
    row.add("topology_s", ours_[i]->trees().statistics().topology_seconds);
    row.add("bounds_s", ours_[i]->trees().statistics().bounds_seconds);
    row.add("peer_build_s", p < sides_.size() ? spread_of(build_seconds_[p]).median : kNotMeasured);
    row.add("build_repetitions", build_seconds_[i].size());
  }

  void write_sizes(JsonRow& row, std::size_t i, std::size_t p) const {
    const bool beside = p < sides_.size();
    const BvhStatistics& tree = ours_[i]->trees().statistics();
    const double triangles = static_cast<double>(std::max<std::uint64_t>(1, primitives_of(tree)));
    row.add("bytes_per_tri", static_cast<double>(ours_[i]->bytes()) / triangles);
    row.add("node_bytes_per_tri", static_cast<double>(tree.node_bytes) / triangles);
    row.add("leaf_bytes_per_tri", static_cast<double>(tree.leaf_bytes) / triangles);
    row.add("vertex_bytes_per_tri", static_cast<double>(tree.vertex_bytes) / triangles);
    row.add("peer_bytes_per_tri",
            beside ? static_cast<double>(sides_[p]->bytes()) / triangles : kNotMeasured);
    row.add("peer_keys", beside ? static_cast<double>(input_.keys) : kNotMeasured);
    row.add("peer_sampled", input_.sampled);
    row.add("peer_sampling_error", input_.sampled ? input_.error : kNotMeasured);
    row.add("peer_missing", input_.missing);
  }

  std::uint32_t most_segments() const {
    std::uint32_t most = 0;
    for (const Mesh& mesh : scene_.scene->meshes) most = std::max(most, mesh.shape.segments);
    for (const Grids& grids : scene_.scene->grids) most = std::max(most, grids.shape.segments);
    for (const Curves& curves : scene_.scene->curves) most = std::max(most, curves.shape.segments);
    for (const Points& points : scene_.scene->points) most = std::max(most, points.shape.segments);
    for (const InstanceSet& set : scene_.scene->instances) most = std::max(most, set.segments);
    return most;
  }
  std::uint32_t most_degree() const {
    std::uint32_t most = 1;
    for (const Mesh& mesh : scene_.scene->meshes) most = std::max(most, mesh.shape.degree);
    for (const Curves& curves : scene_.scene->curves) most = std::max(most, curves.shape.degree);
    for (const Points& points : scene_.scene->points) most = std::max(most, points.shape.degree);
    for (const InstanceSet& set : scene_.scene->instances) most = std::max(most, set.degree);
    return most;
  }

  const BenchScene& scene_;
  const RunSettings& settings_;
  PeerInput input_;
  std::vector<std::shared_ptr<OurSide>> ours_;
  std::vector<std::shared_ptr<PeerSide>> peers_;
  std::vector<std::shared_ptr<Side>> sides_;  // ours, then the peer's
  std::vector<Contestant> contestants_;
  std::vector<std::size_t> first_;  // contestant of each side
  std::vector<std::vector<double>> build_seconds_;
  std::vector<double> misses_;
  std::vector<RaySet> ray_sets_;
  double size_ = 0.0;  // diagonal of the scene's box
  std::vector<std::string> rows_;
};

}  // namespace

std::vector<std::string> run_scene(const BenchScene& scene, const RunSettings& settings) {
  return SceneRun(scene, settings).run();
}

}  // namespace msbvh::bench
