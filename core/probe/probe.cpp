#include "core/probe/probe.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <unordered_map>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/probe/aimed_rays.h"
#include "core/probe/closed_mesh.h"
#include "core/trace/oracle.h"

namespace msbvh {
namespace {

// Closed meshes that rays start in, spread evenly over all that are shown; and starts in each.
constexpr std::size_t kMostMeshes = 64, kStarts = 4;

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

// Rays that start inside of a closed mesh, and whose number it has.
struct InsideRays {
  std::vector<Ray> rays;
  std::vector<const ShownMesh*> from;
};

void add_rays_from(const ShownMeshes& all, const ShownMesh& shown, std::size_t count, ProbeRandom& random,
                   InsideRays& out) {
  const float time = random.time();
  const std::optional<MeshPose> pose = all.pose(shown, double(time));
  if (!pose) return;
  const std::optional<Vec3f> start = point_inside(shown, *pose, random);
  if (!start) return;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<std::uint32_t>(random.below(shown.mesh->triangles.size()));
    const std::array<Vec3d, 3> v = corners(shown, *pose, t);
    const std::size_t k = random.below(3);
    const Vec3d at_edge = v[k] + (v[(k + 1) % 3] - v[k]) * random.uniform();
    const Vec3d ways[] = {random.direction(), v[k] - Vec3d(*start), at_edge - Vec3d(*start)};
    Ray ray;
    ray.org = *start;
    ray.dir = Vec3f(ways[random.below(3)]);
    ray.time = time;
    out.rays.push_back(ray);
    out.from.push_back(&shown);
  }
}

InsideRays inside_rays(const ShownMeshes& all, const std::vector<const ShownMesh*>& closed, std::size_t count,
                       std::uint64_t seed) {
  InsideRays out;
  ProbeRandom random(seed);
  const std::size_t meshes = std::min(closed.size(), kMostMeshes);
  for (std::size_t i = 0; i < meshes; ++i) {
    const ShownMesh& shown = *closed[i * closed.size() / meshes];
    for (std::size_t start = 0; start < kStarts; ++start)
      add_rays_from(all, shown, std::max<std::size_t>(1, count / (meshes * kStarts)), random, out);
  }
  return out;
}

void find_leaks(const Bvh& world, const Tracer& tracer, const InsideRays& inside, ProbeResult& result) {
  compare_ways(world, tracer, inside.rays, result);
  std::vector<Hit> hits(inside.rays.size());
  tracer.intersect(inside.rays, hits.data());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].found()) note(result, inside.rays[i], "it gets out of " + inside.from[i]->mesh->name);
  }
}

std::vector<const ShownMesh*> closed_ones(const ShownMeshes& all, ProbeReport& report) {
  std::unordered_map<const TriangleMesh*, bool> known;
  std::vector<const ShownMesh*> closed;
  for (const ShownMesh& shown : all.meshes()) {
    const auto [at, is_new] = known.try_emplace(shown.mesh, false);
    if (is_new) {
      at->second = is_closed(*shown.mesh);
      ++report.meshes;
      report.closed_meshes += at->second;
    }
    if (at->second) closed.push_back(&shown);
  }
  return closed;
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
  const InsideRays inside = inside_rays(shown, closed_ones(shown, report), settings.rays, settings.seed);
  for (const InstructionSet set : sets) {
    ProbeResult& result =
        report.results.emplace_back(ProbeResult{"rays from inside closed meshes", set, inside.rays.size()});
    find_leaks(world, Tracer(world, set), inside, result);
    finished_one();
  }
  return report;
}

}  // namespace msbvh
