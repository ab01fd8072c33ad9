#include "bench/feature_rows.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "bench/checks.h"
#include "bench/json_row.h"
#include "bench/timing.h"
#include "core/trace/tracer.h"

namespace msbvh::bench {
namespace {

// A pair of sides is traced again until so many seconds are spent, at least thrice.
constexpr double kTraceSeconds = 1.0;
// Hit distances that differ by more than this share of the scene's size count as different.
constexpr double kDistanceTolerance = 1e-4;

// Those that a ray may meet: of all instances.
double triangles_shown(const Bvh& bvh) {
  double sum = 2.0 * static_cast<double>(bvh.statistics.quads);
  for (const auto& mesh : bvh.meshes) sum += static_cast<double>(mesh->triangles.size());
  for (const auto& set : bvh.curves) sum += static_cast<double>(set->span_count());
  for (const auto& set : bvh.points) sum += static_cast<double>(set->point_count);
  for (const Instance& instance : bvh.instances) sum += triangles_shown(*instance.object);
  return sum;
}

struct Answers {
  std::vector<Hit> hits;
  std::unique_ptr<bool[]> occluded;

  explicit Answers(std::size_t count) : hits(count), occluded(new bool[count]()) {}
  std::vector<float> distances(bool any_hit) const {
    constexpr float kNone = std::numeric_limits<float>::infinity();
    std::vector<float> t(hits.size(), kNone);
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (any_hit && occluded[i]) t[i] = 0.0f;
      if (!any_hit && hits[i].found()) t[i] = hits[i].t;
    }
    return t;
  }
};

class Measurement {
 public:
  Measurement(const FeatureRow& row, const FeatureRun& run) : row_(row), run_(run) {}

  std::string run() {
    build();
    const Box3f bounds = bounds_of(*trees_[0].bvh);
    rays_ = make_rays(row_.rays, *row_.scene, bounds, Tracer(*trees_[0].bvh), run_.rays, run_.seed);
    std::vector<Answers> answers;
    for (int i = 0; i < 2; ++i) answers.emplace_back(rays_.size());
    for (const int i : {0, 1}) trace(i, answers[i]);  // warm
    seconds_ = interleave(2, run_.rounds, 3, kTraceSeconds,
                          [&](std::size_t i) { trace(static_cast<int>(i), answers[i]); });
    const double size = length(Vec3d(bounds.extent()));
    differ_ = count_differences(rays_, answers[0].distances(row_.any_hit), answers[1].distances(row_.any_hit),
                                kDistanceTolerance * size);
    return text();
  }

 private:
  const FeatureSide& side(int i) const { return i == 0 ? row_.without : row_.with; }
  bool same_tree() const { return !row_.with.build; }

  // By turns; the last of each side is kept.
  void build() {
    for (int round = 0; round < (same_tree() ? 1 : run_.builds); ++round) {
      for (const int i : {0, 1}) {
        if (i == 1 && same_tree()) continue;
        trees_[i] = {};
        trees_[i] = side(i).build();
        build_seconds_[i].push_back(trees_[i].build_seconds);
      }
    }
    if (!same_tree()) return;
    trees_[1] = trees_[0];
    build_seconds_[1] = build_seconds_[0];
  }

  static Box3f bounds_of(const Bvh& bvh) {
    Box3f box;
    for (const Box3f& at_control : bvh.root_bounds) box.grow(at_control);
    return box;
  }

  void trace(int i, Answers& out) const {
    const Tracer tracer(*trees_[i].bvh);
    if (side(i).at_once) {
      row_.any_hit ? tracer.occluded(rays_, out.occluded.get()) : tracer.intersect(rays_, out.hits.data());
      return;
    }
    for (std::size_t r = 0; r < rays_.size(); ++r) {
      if (row_.any_hit) {
        out.occluded[r] = tracer.occluded(rays_[r]);
      } else {
        tracer.intersect(rays_[r], out.hits[r]);
      }
    }
  }

  std::string text() const {
    JsonRow out;
    out.add("feature", row_.feature.name);
    out.add("what", row_.feature.what);
    out.add("source", row_.feature.source);
    out.add("test", row_.feature.test);
    out.add("scene", row_.scene_name);
    out.add("triangles", triangles_shown(*trees_[0].bvh));
    out.add("rays", ray_kind_name(row_.rays));
    out.add("any_hit", row_.any_hit);
    out.add("ray_count", rays_.size());
    out.add("rounds", seconds_[0].size());
    for (const int i : {0, 1}) add_side(out, i);
    const Spread ratio = speed_ratio(seconds_[1], seconds_[0]);
    out.add("ratio", ratio.median);
    out.add("ratio_low", ratio.low);
    out.add("ratio_high", ratio.high);
    out.add("hits_differ", differ_);
    return out.text();
  }

  void add_side(JsonRow& out, int i) const {
    const std::string prefix = i == 0 ? "without" : "with";
    const auto add = [&](const char* key, const auto& value) { out.add((prefix + key).c_str(), value); };
    const TraceCounts work =
        count_work(*trees_[i].bvh, row_.any_hit ? RayKind::kShadow : RayKind::kRandom, rays_);
    const double triangles = std::max(1.0, triangles_shown(*trees_[i].bvh)), rays = double(work.rays);
    add("", side(i).name);
    add("_keys", side(i).keys);
    add("_mrays", 1e-6 * double(rays_.size()) / spread_of(seconds_[i]).median);
    add("_nodes_per_ray", double(work.nodes) / rays);
    add("_tests_per_ray", double(work.primitives) / rays);
    add("_bytes_per_tri", double(trees_[i].bytes) / triangles);
    add("_node_bytes_per_tri", double(trees_[i].bvh->statistics.node_bytes) / triangles);
    add("_build_s", spread_of(build_seconds_[i]).median);
  }

  const FeatureRow& row_;
  const FeatureRun& run_;
  FeatureTree trees_[2];  // without, with
  std::vector<double> build_seconds_[2];
  std::vector<Ray> rays_;
  std::vector<std::vector<double>> seconds_;
  std::size_t differ_ = 0;
};

}  // namespace

std::string measure(const FeatureRow& row, const FeatureRun& run) { return Measurement(row, run).run(); }

}  // namespace msbvh::bench
