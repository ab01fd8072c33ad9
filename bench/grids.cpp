// Patches of grids as leaves against the same triangles in the tree: bytes a quad, build time and rays a
// second, one line a key count. docs/design/subdivision.md has its figures.
//
//   msbvh_bench_grids [LEVEL [ROUNDS [BUILDER]]]
//
// The surface: a displaced prism of 40 sides, 2 units across, turning by 1 radian; 2^LEVEL segments an edge.
// Rays: 2^18 random ones at random times, and 2^18 from a pinhole, one by one and all at once; one thread,
// rounds interleaved, the same hits required.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/timing.h"
#include "core/api/accel.h"
#include "core/base/parallel.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "core/geometry/grid_triangles.h"
#include "core/trace/tracer.h"
#include "tests/support/cages.h"

namespace {

using namespace msbvh;
using namespace msbvh::procedural;

constexpr int kRays = 1 << 18, kSide = 1 << 9;

std::vector<Ray> random_rays() {
  Random random(1);
  std::vector<Ray> out;
  for (int i = 0; i < kRays; ++i) out.push_back(random_ray(random, {}, 1.5f));
  return out;
}

std::vector<Ray> pinhole_rays() {
  Random random(2);
  std::vector<Ray> out;
  for (int i = 0; i < kRays; ++i) {
    const float x = (float(i % kSide) + random.uniform()) / kSide - 0.5f;
    const float y = (float(i / kSide) + random.uniform()) / kSide - 0.5f;
    out.push_back(
        {.org = {0.3f, 0.5f, 4.0f}, .dir = {0.6f * x, 0.6f * y - 0.12f, -1.0f}, .time = random.uniform()});
  }
  return out;
}

struct Sums {
  std::uint64_t hits = 0, triangles = 0;
  double t = 0.0;
  bool operator==(const Sums&) const = default;
};

// One by one, or all at once.
Sums trace(const Accel& accel, const std::vector<Ray>& rays, bool at_once) {
  std::vector<Hit> hits(rays.size());
  const Tracer tracer(accel.bvh());
  if (at_once) tracer.intersect(rays, hits.data());
  for (std::size_t i = 0; !at_once && i < rays.size(); ++i) tracer.intersect(rays[i], hits[i]);
  Sums sums;
  for (const Hit& hit : hits) {
    if (!hit.found()) continue;
    ++sums.hits;
    sums.triangles += hit.triangle;
    sums.t += double(hit.t);
  }
  return sums;
}

void run_rays(const char* name, const Accel& patches, const Accel& triangles, const std::vector<Ray>& rays,
              bool at_once, int rounds) {
  if (trace(patches, rays, at_once) != trace(triangles, rays, !at_once))
    throw std::runtime_error("the hits differ");
  const auto seconds = bench::interleave(
      2, rounds, rounds, 1e9, [&](std::size_t side) { trace(side ? triangles : patches, rays, at_once); });
  const bench::Spread ours = bench::spread_of(seconds[0]), theirs = bench::spread_of(seconds[1]);
  const bench::Spread ratio = bench::speed_ratio(seconds[0], seconds[1]);
  std::printf(" %s %.2f | %.2f | %.2f [%.2f, %.2f] |", name, kRays / ours.median * 1e-6,
              kRays / theirs.median * 1e-6, ratio.median, ratio.low, ratio.high);
}

void run(std::uint32_t level, int rounds, const BuildSettings& settings) {
  std::puts(
      "| keys | quads | bytes a quad: tree + points | of triangles | dice s | build s | of triangles "
      "| rays: M/s | of triangles | ratio | and so on |");
  for (const std::uint32_t segments : {0u, 1u, 8u, 32u}) {
    const SubdivisionMesh cage = moved(prism_cage(40), {segments, 1}, rotation({1, 2, 3}, 1.0));
    const Stopwatch dicing;
    const GridMesh grids = dice(cage, {.level = level, .displacement = bumps(0.03, 0.2)});
    const double dice_seconds = dicing.seconds();
    Accel patches, triangles;
    patches.add_grids(grids);
    triangles.add_mesh(triangles_of(grids));
    patches.commit(settings);
    triangles.commit(settings);
    const BvhStatistics &p = patches.statistics(), &t = triangles.statistics();
    const double quads = grids.quad_count;
    std::printf("| %u | %u | %.1f + %.1f | %.1f + %.1f | %.3f | %.3f | %.3f |", segments + 1,
                grids.quad_count, double(p.node_bytes + p.leaf_bytes) / quads, double(p.grid_bytes) / quads,
                double(t.node_bytes + t.leaf_bytes) / quads, double(t.vertex_bytes) / quads, dice_seconds,
                p.build_seconds, t.build_seconds);
    run_rays("random", patches, triangles, random_rays(), false, rounds);
    run_rays("pinhole", patches, triangles, pinhole_rays(), false, rounds);
    run_rays("random at once", patches, triangles, random_rays(), true, rounds);
    run_rays("pinhole at once", patches, triangles, pinhole_rays(), true, rounds);
    std::puts("");
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto level = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 5);
    BuildSettings settings;
    if (argc > 3 && std::string(argv[3]) == "mbvh") settings.builder = Builder::kMbvh;
    Arena(1).execute([&] { run(level, argc > 2 ? std::atoi(argv[2]) : 5, settings); });
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "msbvh_bench_grids: error: %s\n", error.what());
    return 1;
  }
}
