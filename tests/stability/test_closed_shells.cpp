// The long check of traversal: closed shells of random shapes, motions, key counts, places and builders. A
// ray from inside of one that hits nothing is a leak, and needs no oracle; some of the rays are held against
// it as well.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>

#include "bench/moved_mesh.h"
#include "bench/shapes.h"
#include "core/base/parallel.h"
#include "core/motion/affine_track.h"
#include "tests/property/support.h"
#include "tests/support/soak.h"

using namespace msbvh;
using namespace msbvh::procedural;

namespace {

constexpr std::size_t kRaysOfShell = 1u << 14;
constexpr std::size_t kSingleEvery = 8;     // of them are traced one by one as well
constexpr std::size_t kJudgedOfShell = 32;  // by the oracle, on each instruction set
// Two rotations about this much apart leave the sphere that is interpolated between them wide open.
constexpr double kMostRadiansOfSegment = 2.0;
// How far from its centre a ray starts, as a share of the way to a vertex.
constexpr float kInside = 0.3f;

template <typename T, std::size_t N>
const T& one_of(Random& random, const T (&choices)[N]) {
  return choices[random.next() % N];
}

// Everything about a shell follows from its seed.
struct Shell {
  Accel accel;
  // Its own space: the world, or that of the one instance. The last vertex is its centre, which no triangle
  // uses.
  std::shared_ptr<const TriangleMesh> mesh;
  TrackForm instance_form;
  std::vector<Affine3f> world_from_shell;  // empty: it is in the world
  std::string description;
};

TrackForm random_form(Random& random) {
  const std::uint32_t segments = one_of(random, {0u, 1u, 1u, 2u, 4u, 8u, 16u, 32u, 128u});
  if (segments == 0) return {0, 1};
  return {segments, segments > 16 ? 1u : one_of(random, {1u, 1u, 2u, 3u})};
}

bench::Pose random_pose(Random& random) {
  const auto triangles = static_cast<std::uint32_t>(std::exp(random.uniform(4.5f, 8.5f)));  // 90 to 5000
  bench::Pose pose = random.next() % 4 == 0
                         ? bench::cube_shell(triangles, random.uniform(0.7f, 1.0f))
                         : bench::bumpy_sphere(triangles, random.uniform(0.0f, 0.2f), random);
  pose.positions.push_back({});
  return pose;
}

// Turns about an axis, drifts, and sometimes swells here and there; always star-shaped about its centre.
Motion random_motion(Random& random, const TrackForm& form) {
  const double most = std::min(4.0, form.segments * kMostRadiansOfSegment);
  const Motion turn = rotation(Vec3d(random.direction()), random.uniform(0.0f, 1.0f) * most);
  const Vec3d drift = Vec3d(random.direction()) * double(std::exp(random.uniform(-5.0f, 4.0f)));
  const Vec3d waves = Vec3d(random.direction()) * 5.0;
  const double swell = random.next() % 3 == 0 ? 0.1 : 0.0;
  return [=](const Vec3d& p, double u) {
    return turn(p * (1.0 + swell * std::sin(dot(p, waves) + 3.0 * u)), u) + drift * (u - 0.5);
  };
}

// Of linear maps that are close to each other: what is interpolated between two of them is invertible.
std::vector<Affine3f> random_maps(Random& random, const TrackForm& form, double scale, const Vec3d& place) {
  const Motion turn = rotation(Vec3d(random.direction()), random.uniform(0.0f, 1.5f));
  const Vec3d drift = Vec3d(random.direction()) * (scale * random.uniform(0.0f, 3.0f));
  std::vector<Affine3f> maps;
  for (std::uint32_t i = 0; i < form.controls(); ++i) {
    const double u = form.moving() ? double(i) / (form.controls() - 1) : 0.5;
    const auto column = [&](const Vec3d& axis) { return turn(axis, u) * scale; };
    maps.push_back(Affine3f(
        Affine3d{column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1}), place + drift * (u - 0.5)}));
  }
  return maps;
}

BuildSettings random_builder(Random& random, std::ostringstream& about) {
  const BuilderName& builder = random.next() % 4 == 0 ? one_of(random, kBuilders) : kBuilders[0];
  about << ", builder " << builder.name;
  BuildSettings settings;
  settings.builder = builder.builder;
  return settings;
}

// Things inside, on tracks of their own: they only get in the way.
void add_clutter(Random& random, double scale, const Vec3d& place, Accel& accel) {
  const TrackForm form = random_form(random);
  const Motion spin = rotation(Vec3d(random.direction()), 1.0);
  accel.add_mesh(moved(
      sticks(10, random.next()), form, [=](const Vec3d& p, double u) { return spin(p, u) * (0.1 * scale); },
      place));
}

Shell random_shell(std::uint64_t seed) {
  Random random(seed);
  Shell shell;
  std::ostringstream about;
  const TrackForm form = random_form(random);
  const double scale = std::exp2(random.uniform(-10.0f, 10.0f));
  const double distance = one_of(random, {0.0, 1.0, 1e2, 1e3, 1e4, 1e5}) * scale;
  const Vec3d place = Vec3d(random.direction()) * distance;
  const bool instanced = random.next() % 4 == 0;
  about << "seed " << seed << ": " << form.segments << " segments of degree " << form.degree << ", size "
        << scale << ", distance " << distance << (instanced ? ", instanced" : "");
  const Motion motion = random_motion(random, form);
  const auto in_place = [&](std::uint32_t, const Vec3d& p, double u) {
    return instanced ? motion(p, u) : motion(p, u) * scale + place;
  };
  shell.mesh =
      std::make_shared<TriangleMesh>(bench::moved_mesh("shell", random_pose(random), form, in_place));
  const BuildSettings settings = random_builder(random, about);
  if (instanced) {
    const auto object = std::make_shared<Accel>();
    object->add_mesh(shell.mesh);
    object->commit(settings);
    shell.instance_form = random_form(random);
    shell.world_from_shell = random_maps(random, shell.instance_form, scale, place);
    shell.accel.add_instances(object, shell.instance_form, shell.world_from_shell);
  } else {
    shell.accel.add_mesh(shell.mesh);
  }
  if (random.next() % 3 == 0) add_clutter(random, scale, place, shell.accel);
  shell.accel.commit(settings);
  shell.description = about.str();
  return shell;
}

// From inside: half of them anywhere, the others at vertices and edges, where leaks would be.
std::vector<Ray> rays_inside(const Shell& shell, std::uint64_t seed) {
  Random random(seed ^ 0x5eedull);
  const TriangleMesh& mesh = *shell.mesh;
  std::vector<Ray> rays(kRaysOfShell);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray& ray = rays[i];
    ray.time = i % 64 == 0 ? one_of(random, {0.0f, 0.25f, 0.5f, 1.0f}) : random.uniform();
    Affine3d world;  // from the shell
    const bool instanced = !shell.world_from_shell.empty();
    if (instanced) world = Affine3d(evaluate(shell.world_from_shell, shell.instance_form, ray.time));
    const auto at = [&](std::uint32_t vertex) {
      const Vec3d p(mesh.position(vertex, ray.time));
      return instanced ? world.point(p) : p;
    };
    const Vec3d centre = at(mesh.vertex_count - 1);
    const Vec3d start =
        centre + (at(random.next() % (mesh.vertex_count - 1)) - centre) * double(kInside * random.uniform());
    ray.org = Vec3f(start);
    const Triangle& triangle = mesh.triangles[random.next() % mesh.triangles.size()];
    const double along = i % 4 == 0 ? 0.0 : double(random.uniform());  // 0: at the vertex
    const Vec3d aim = at(triangle[0]) * (1.0 - along) + at(triangle[1]) * along;
    ray.dir = i % 2 == 0 ? Vec3f(aim - Vec3d(ray.org)) : random.direction();
  }
  return rays;
}

struct Findings {
  std::atomic<std::uint64_t> rays{0}, leaks{0}, judged{0}, wrong{0}, shells{0};
  std::mutex mutex;
  std::string first;  // wrong one, for people

  void note(const std::string& what) {
    const std::scoped_lock lock(mutex);
    if (first.empty()) first = what;
  }
};

void count_leaks(const Shell& shell, const Tracer& tracer, const std::vector<Ray>& rays, Findings& out) {
  std::vector<Hit> hits(rays.size());
  const auto occluded = std::make_unique<bool[]>(rays.size());
  tracer.intersect(rays, hits.data());
  tracer.occluded(rays, occluded.get());
  std::uint64_t leaks = 0, traced = 2 * rays.size();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    leaks += !hits[i].found() + !occluded[i];
    if (i % kSingleEvery != 0) continue;
    Hit hit;
    leaks += !tracer.intersect(rays[i], hit);
    ++traced;
  }
  out.rays += traced;
  out.leaks += leaks;
  if (leaks) out.note(shell.description + ": " + std::to_string(leaks) + " leaks");
}

void judge(const Shell& shell, const Tracer& tracer, const std::vector<Ray>& rays, Findings& out) {
  for (std::size_t i = 0; i < kJudgedOfShell; ++i) {
    const Ray& ray = rays[i * rays.size() / kJudgedOfShell + i];
    Hit hit;
    const bool found = tracer.intersect(ray, hit);
    const Bvh& bvh = shell.accel.bvh();
    const auto wrong = judge_intersection(bvh, ray, found ? std::optional(hit) : std::nullopt);
    const auto wrong_shadow = judge_occlusion(bvh, ray, tracer.occluded(ray));
    out.judged += 2;
    out.wrong += wrong.has_value() + wrong_shadow.has_value();
    if (wrong || wrong_shadow)
      out.note(shell.description + ": " + wrong.value_or("") + wrong_shadow.value_or(""));
  }
}

void check_shell(std::uint64_t seed, Findings& out) {
  const Shell shell = random_shell(seed);
  const std::vector<Ray> rays = rays_inside(shell, seed);
  for (const InstructionSet set : supported_instruction_sets()) {
    const Tracer tracer(shell.accel.bvh(), set);
    count_leaks(shell, tracer, rays, out);
    judge(shell, tracer, rays, out);
  }
  ++out.shells;
}

}  // namespace

TEST_SUITE("slow") {
  TEST_CASE(
      "soak: a billion rays from inside of random closed shells: none gets out, and the oracle agrees") {
    const std::uint64_t wanted = test::soak_count(5'000'000, 1'000'000'000);
    constexpr std::size_t kShellsAtOnce = 64;
    Findings found;
    for (std::uint64_t first = 1; found.rays < wanted; first += kShellsAtOnce)
      parallel_for(kShellsAtOnce, [&](std::size_t i) {
        if (found.rays < wanted || test::is_soak()) check_shell(first + i, found);
      });
    INFO(found.first);
    CHECK(found.leaks == 0);
    CHECK(found.wrong == 0);
    std::ostringstream figure;
    figure << double(found.rays) << " rays in " << found.shells << " shells, " << found.leaks << " leaks; "
           << found.judged << " judged by the oracle, " << found.wrong << " wrong";
    test::soak_figure("rays", figure.str());
  }
}
