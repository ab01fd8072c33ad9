#include "core/cost/ray_costs.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/cost/cost_tally.h"
#include "core/cost/path_rays.h"
#include "core/trace/trace_visit.h"

namespace msbvh {
namespace {

constexpr std::size_t kPathsPerTask = 64;
constexpr std::uint64_t kPathsPerProgress = 4096;  // some ten milliseconds

// What a thread needs to count paths, and what it has counted.
struct Counter {
  explicit Counter(const CostTally& none) : tally(none) {}

  PathBatch batch;
  PathRays rays;
  std::vector<TraceVisit> visits;
  TraceCounts all, camera;
  CostTally tally;
};

class Counting {
 public:
  Counting(const Frame& frame, const CostTally& none) : frame_(frame), tracer_(frame.world), none_(none) {}

  void count(const SampledPaths& paths, std::uint64_t first, std::uint64_t last) {
    parallel_for_ranges(last - first, kPathsPerTask, [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<Counter> counter = take();
      for (std::size_t i = begin; i < end; ++i) count(paths[first + i], *counter);
      give_back(std::move(counter));
    });
  }
  // All are whole numbers: their sum does not depend on who counted what.
  Counter sum() const {
    Counter sum(none_);
    for (const std::unique_ptr<Counter>& counter : idle_) {
      sum.all += counter->all;
      sum.camera += counter->camera;
      sum.tally += counter->tally;
    }
    return sum;
  }

 private:
  void count(const PathId& path, Counter& counter) const {
    counter.rays.clear();
    add_path_rays(frame_, path, counter.batch, counter.rays);
    counter.camera += counted(counter.rays.camera, counter);
    counted(counter.rays.bounce, counter);
    counted(counter.rays.shadow, counter);
  }
  TraceCounts counted(const RayLog& log, Counter& counter) const {
    TraceCounts counts;
    counts.visits = &counter.visits;
    Hit hit;
    for (const Ray& ray : log.closest) {
      counter.visits.clear();
      tracer_.intersect_counted(ray, hit, counts);
      counter.tally.add(counter.visits);
    }
    for (const Ray& ray : log.any) {
      counter.visits.clear();
      tracer_.occluded_counted(ray, counts);
      counter.tally.add(counter.visits);
    }
    counter.all += counts;
    return counts;
  }

  std::unique_ptr<Counter> take() {
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return std::make_unique<Counter>(none_);
    std::unique_ptr<Counter> counter = std::move(idle_.back());
    idle_.pop_back();
    return counter;
  }
  void give_back(std::unique_ptr<Counter> counter) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(counter));
  }

  const Frame& frame_;
  const Tracer tracer_;
  const CostTally& none_;  // to begin with
  std::mutex mutex_;
  std::vector<std::unique_ptr<Counter>> idle_;
};

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

void set_prims(const SceneRows& rows, const CostTally& tally, const SceneOwners& owners, RayCosts& costs) {
  const std::vector<double> build_seconds = owners.build_seconds(), tree_bytes = owners.tree_bytes();
  double all = tally.empty_cost();
  for (std::uint32_t row = 0; row < rows.size(); ++row) all += tally.cost(row);
  costs.cost = all;
  const double build = std::accumulate(build_seconds.begin(), build_seconds.end(), 0.0);
  for (std::uint32_t row = 0; row < rows.size(); ++row) {
    const TalliedWork& work = tally.of(row);
    costs.prims.push_back({.path = rows.name(row),
                           .geometry = rows.id(row),
                           .nodes = work.nodes(),
                           .instances = work.instances(),
                           .blocks = work.blocks,
                           .primitives = work.primitives,
                           .share = share(tally.cost(row), all),
                           .build_share = share(build_seconds[row], build),
                           .tree_bytes = tree_bytes[row]});
  }
  costs.empty_nodes = tally.of_empty_space().nodes();
  costs.empty_share = share(tally.empty_cost(), all);
}

void expect_samples(const RayCostSettings& settings) {
  if (settings.camera_samples == 0) throw Error("ray costs: camera_samples: found 0; expected at least 1");
}

}  // namespace

RayCosts ray_costs(const Frame& frame, const BuildSettings& build, std::uint32_t spp,
                   const RayCostSettings& settings, const RayCostProgress& progress) {
  expect_samples(settings);
  const SampledPaths paths(frame.width, frame.height, spp, frame.seed, settings.camera_samples);
  const SceneRows rows(frame.scene());
  const SceneOwners owners(frame.index, rows, frame.world);
  const CostTally none(rows, owners, CostModel(build));
  Counting counting(frame, none);
  for (std::uint64_t first = 0; first < paths.size(); first += kPathsPerProgress) {
    const std::uint64_t last = std::min(paths.size(), first + kPathsPerProgress);
    counting.count(paths, first, last);
    if (progress && !progress(static_cast<double>(last) / static_cast<double>(paths.size())))
      throw Cancelled();
  }
  const Counter sum = counting.sum();
  RayCosts costs;
  costs.paths = paths.size();
  costs.all = sum.all;
  costs.camera = sum.camera;
  set_prims(rows, sum.tally, owners, costs);
  return costs;
}

}  // namespace msbvh
