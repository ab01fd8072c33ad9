// Build and trace times on seeded procedural scenes, MSBVH beside MBVH, as a Markdown table on stdout.
//
//   msbvh_bench [TRIANGLES [SEED [REPETITIONS]]]
//
// Rays: random pairs of points on the sphere around the scene, random times, no order: the worst case for
// caches and the one that other libraries are measured by. All threads of the machine trace. Times are
// medians; the spread is the larger deviation from the median, in per cent.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "bench/scenes.h"
#include "core/api/accel.h"
#include "core/base/parallel.h"

namespace msbvh::bench {
namespace {

constexpr std::size_t kRays = 1u << 20;
constexpr std::size_t kRaysPerTask = 1u << 12;
constexpr std::uint32_t kSegments[] = {0, 1, 8, 128};  // 1, 2, 9 and 129 keys

using MeshPointer = std::shared_ptr<const TriangleMesh>;

struct Timing {
  double median = 0.0;          // seconds
  double spread_percent = 0.0;  // largest deviation from the median
};

Timing measure(int repetitions, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2];
  const double worst = std::max(seconds.back() - median, median - seconds.front());
  return {median, 100.0 * worst / median};
}

std::vector<Ray> random_rays(std::uint32_t seed) {
  std::mt19937 engine(seed);
  const auto in = [&](float lo, float hi) {
    return lo + (hi - lo) * (static_cast<float>(engine() >> 8) * 0x1p-24f);
  };
  const auto on_sphere = [&]() -> Vec3f {
    const float z = in(-1.0f, 1.0f), phi = in(0.0f, 2.0f * std::numbers::pi_v<float>),
                r = std::sqrt(1.0f - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  };
  std::vector<Ray> rays(kRays);
  for (Ray& ray : rays) {
    ray.org = on_sphere();
    ray.dir = on_sphere() - ray.org;
    if (dot(ray.dir, ray.dir) == 0.0f) ray.dir = -ray.org;
    ray.time = in(0.0f, 1.0f);
  }
  return rays;
}

std::size_t trace(const Accel& accel, const std::vector<Ray>& rays) {
  std::vector<std::size_t> hits((kRays + kRaysPerTask - 1) / kRaysPerTask);
  parallel_for_ranges(rays.size(), kRaysPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Hit hit;
      hits[begin / kRaysPerTask] += accel.intersect(rays[i], hit);
    }
  });
  std::size_t sum = 0;
  for (const std::size_t count : hits) sum += count;
  return sum;
}

TraceCounts count(const Accel& accel, const std::vector<Ray>& rays) {
  const Tracer tracer(accel.bvh());
  TraceCounts counts;
  for (std::size_t i = 0; i < rays.size(); i += 64) {
    Hit hit;
    tracer.intersect_counted(rays[i], hit, counts);
  }
  return counts;
}

// One line of the table. Returns the number of hits: both builders must find the same ones, up to ties.
std::size_t run(const SceneKind& scene, const MeshPointer& mesh, Builder builder,
                const std::vector<Ray>& rays, int repetitions) {
  Accel accel;
  const Timing build = measure(repetitions, [&] {
    accel = Accel();
    accel.add_mesh(mesh);
    BuildSettings settings;
    settings.builder = builder;
    accel.commit(settings);
  });
  std::size_t hits = 0;
  const Timing tracing = measure(repetitions, [&] { hits = trace(accel, rays); });
  const TraceCounts counts = count(accel, rays);
  const BvhStatistics& tree = accel.statistics();
  const double triangles = static_cast<double>(tree.triangles), traced = static_cast<double>(counts.rays);
  std::printf("| %s | %u | %s | %.0f | %.0f %% | %.2f | %.0f %% | %.2f | %.0f | %.1f | %.1f |\n", scene.name,
              key_count(mesh->segments), builder == Builder::kMsbvh ? "msbvh" : "mbvh", 1e3 * build.median,
              build.spread_percent, 1e-6 * kRays / tracing.median, tracing.spread_percent,
              static_cast<double>(tree.references) / triangles,
              static_cast<double>(tree.node_bytes + tree.leaf_bytes + tree.vertex_bytes) / triangles,
              static_cast<double>(counts.nodes) / traced, static_cast<double>(counts.triangles) / traced);
  std::fflush(stdout);
  return hits;
}

int run_all(std::uint32_t triangles, std::uint32_t seed, int repetitions) {
  const char* set = instruction_set_name(supported_instruction_sets().back());
  std::printf("%u triangles, 2^20 random rays, seed %u, %s, %u threads, median of %d\n\n", triangles, seed,
              set, Arena(0).threads(), repetitions);
  std::printf(
      "| scene | keys | builder | build ms | spread | Mrays/s | spread | references/triangle | "
      "bytes/triangle "
      "| nodes/ray | triangles/ray |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  const std::vector<Ray> rays = random_rays(seed);
  int status = EXIT_SUCCESS;
  for (const SceneKind& scene : kScenes) {
    for (const std::uint32_t segments : kSegments) {
      const auto mesh =
          std::make_shared<const TriangleMesh>(validated(scene.make(triangles, segments, seed)));
      const std::size_t msbvh_hits = run(scene, mesh, Builder::kMsbvh, rays, repetitions);
      const std::size_t mbvh_hits = run(scene, mesh, Builder::kMbvh, rays, repetitions);
      if (msbvh_hits == mbvh_hits) continue;
      std::fprintf(stderr, "%s, %u keys: msbvh hits %zu rays, mbvh %zu\n", scene.name, key_count(segments),
                   msbvh_hits, mbvh_hits);
      status = EXIT_FAILURE;
    }
  }
  return status;
}

}  // namespace
}  // namespace msbvh::bench

int main(int argc, char** argv) {
  const auto argument = [&](int index, int fallback) {
    return argc > index ? std::atoi(argv[index]) : fallback;
  };
  const int triangles = argument(1, 100000), seed = argument(2, 1), repetitions = argument(3, 3);
  if (argc > 4 || triangles < 64 || repetitions < 1) {
    std::fprintf(stderr, "usage: msbvh_bench [TRIANGLES (64 or more) [SEED [REPETITIONS]]]\n");
    return 2;
  }
  try {
    return msbvh::bench::run_all(static_cast<std::uint32_t>(triangles), static_cast<std::uint32_t>(seed),
                                 repetitions);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "msbvh_bench: error: %s\n", error.what());
    return 1;
  }
}
