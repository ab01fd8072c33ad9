#include "core/probe/probe.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <unordered_set>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/probe/aimed_rays.h"
#include "core/probe/closed_mesh.h"
#include "core/probe/inside_rays.h"
#include "core/probe/tracer_under_test.h"
#include "core/trace/oracle.h"

namespace msbvh {
namespace {

// Closed meshes that rays start in, spread evenly over all that are shown; and places in each that they start
// at.
constexpr std::size_t kMostMeshes = 64, kStarts = 8;

std::string describe(const Ray& ray) {
  std::ostringstream s;
  s.precision(9);
  s << "ray from (" << ray.org.x << ", " << ray.org.y << ", " << ray.org.z << ") along (" << ray.dir.x << ", "
    << ray.dir.y << ", " << ray.dir.z << "), at the time " << ray.time << " of the shutter";
  return s.str();
}

std::string describe(const Bvh& world, const Hit& hit) {
  if (!hit.found()) return "nothing";
  std::ostringstream s;
  s.precision(9);
  const Bvh& tree = hit.instance == kNoInstance ? world : *world.instances[hit.instance].object;
  if (hit.geometry.kind() == GeometryKind::kTriangleMesh) s << tree.meshes[hit.geometry.index()]->name << " ";
  s << "primitive " << hit.triangle << " at t = " << hit.t;
  return s.str();
}

void note(ProbeResult& result, const Ray& ray, const std::string& what) {
  if (result.wrong++ == 0) result.first = describe(ray) + ": " + what;
}

// What one way of tracing says must be what all say, to the bit.
void compare_ways(const Bvh& world, const Tracer& tracer, const std::vector<Ray>& rays, ProbeResult& result) {
  std::vector<Hit> many(rays.size());
  const auto occluded = std::make_unique<bool[]>(rays.size());
  tracer.intersect(rays, many.data());
  tracer.occluded(rays, occluded.get());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit one;
    if (!tracer.intersect(rays[i], one)) one = Hit{};
    if (!(one == many[i])) {
      note(result, rays[i],
           "alone it hits " + describe(world, one) + ", among many " + describe(world, many[i]));
    } else if (tracer.occluded(rays[i]) != one.found() || occluded[i] != one.found()) {
      note(result, rays[i], "asked for any hit and for the closest one, the answers differ");
    }
  }
}

void judge(const Bvh& world, const Tracer& tracer, const std::vector<Ray>& rays, double tests,
           ProbeResult& result) {
  const auto affordable =
      static_cast<std::size_t>(std::max(1.0, tests / std::max(1.0, oracle_tests_per_ray(world))));
  result.judged = std::min(rays.size(), affordable);
  std::vector<std::optional<std::string>> wrong(result.judged);
  parallel_for(result.judged, [&](std::size_t i) {
    const Ray& ray = rays[i * rays.size() / result.judged];
    Hit hit;
    const bool found = tracer.intersect(ray, hit);
    wrong[i] = judge_intersection(world, ray, found ? std::optional(hit) : std::nullopt);
    if (!wrong[i]) wrong[i] = judge_occlusion(world, ray, tracer.occluded(ray));
  });
  for (std::size_t i = 0; i < result.judged; ++i) {
    if (wrong[i]) note(result, rays[i * rays.size() / result.judged], *wrong[i]);
  }
}

void find_leaks(const Bvh& world, InstructionSet set, const InsideRays& inside, ProbeResult& result) {
  compare_ways(world, Tracer(world, set), inside.rays, result);
  constexpr std::size_t kOne = 0;  // the other ways are compared with it
  for (const std::size_t i : lost_rays(OurTracerUnderTest(world, set), kOne, inside.rays)) {
    note(result, inside.rays[i],
         std::string(inside_aim_name(inside.aims[i])) + ", it gets out of " + inside.from[i]->mesh->name);
  }
}

// Counts meshes, and returns those that are closed.
std::vector<const ShownMesh*> closed_ones(const ShownMeshes& all, ProbeReport& report) {
  std::vector<const ShownMesh*> closed = closed_meshes(all);
  const auto count = [](const auto& meshes, const auto& mesh_of) {
    std::unordered_set<const TriangleMesh*> known;
    for (const auto& shown : meshes) known.insert(mesh_of(shown));
    return known.size();
  };
  report.meshes = count(all.meshes(), [](const ShownMesh& shown) { return shown.mesh; });
  report.closed_meshes = count(closed, [](const ShownMesh* shown) { return shown->mesh; });
  return closed;
}

// Spread evenly over all.
std::vector<const ShownMesh*> at_most(std::size_t count, const std::vector<const ShownMesh*>& meshes) {
  std::vector<const ShownMesh*> chosen(std::min(count, meshes.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = meshes[i * meshes.size() / chosen.size()];
  return chosen;
}

}  // namespace

ProbeReport probe(const Bvh& world, const ProbeSettings& settings, const ProbeProgress& progress) {
  ProbeReport report;
  const std::vector<InstructionSet> sets = supported_instruction_sets();
  std::size_t done = 0;
  const std::size_t all = (std::size(kAims) + 1) * sets.size();
  const auto finished_one = [&] {
    if (progress && !progress(static_cast<double>(++done) / static_cast<double>(all))) throw Cancelled();
  };
  for (const Aim aim : kAims) {
    const std::vector<Ray> rays = aimed_rays(world, aim, settings.rays, settings.seed + std::size_t(aim));
    for (const InstructionSet set : sets) {
      const Tracer tracer(world, set);
      ProbeResult& result =
          report.results.emplace_back(ProbeResult{std::string("rays ") + aim_name(aim), set, rays.size()});
      compare_ways(world, tracer, rays, result);
      judge(world, tracer, rays, settings.oracle_tests, result);
      finished_one();
    }
  }
  const ShownMeshes shown(world);
  const InsideRays inside = inside_rays(shown, at_most(kMostMeshes, closed_ones(shown, report)), kStarts,
                                        settings.rays, settings.seed);
  for (const InstructionSet set : sets) {
    ProbeResult& result =
        report.results.emplace_back(ProbeResult{"rays from inside closed meshes", set, inside.rays.size()});
    find_leaks(world, set, inside, result);
    finished_one();
  }
  return report;
}

}  // namespace msbvh
