// The long check of traversal: closed shells of random shapes, motions, key counts, places and builders. A
// ray from inside of one that hits nothing is a leak, and needs no oracle; some of the rays are held against
// it as well.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
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
// Roundings of 2^-24 that a ray along a face is away from it: more than the tracer's error, which is about 50
// (docs/design/watertight.md, section 4).
constexpr double kRoundingsFromFace = 256.0;
// A shell that turns inside out is looked at while it is at least this share of its size.
constexpr float kLeastVolume = 0.02f;

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
  // It shrinks to its centre at the middle of the shutter and comes out mirrored.
  bool inverts = false;
  double face_distance = 0.0;  // of rays along faces, as a share of the way to the centre
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

// Any angle up to what the keys can follow, or just half a turn, one, or two.
double random_turn(Random& random, const TrackForm& form) {
  const double most = std::min(4.0 * std::numbers::pi, form.segments * kMostRadiansOfSegment);
  const double angle = random.uniform() * most, halves = one_of(random, {0.0, 0.0, 1.0, 2.0, 4.0});
  const double exact = halves * std::numbers::pi;
  return exact > 0.0 && exact <= most ? exact : angle;
}

// Turns about an axis and drifts, and sometimes swells here and there; or shears; or shrinks through a point
// and is mirrored. Always star-shaped about its centre, but for where it has no volume.
Motion random_motion(Random& random, const TrackForm& form, bool inverts) {
  const Motion turn = rotation(Vec3d(random.direction()), random_turn(random, form));
  const Vec3d drift = Vec3d(random.direction()) * double(std::exp(random.uniform(-5.0f, 4.0f)));
  const Vec3d waves = Vec3d(random.direction()) * 5.0;
  const Vec3d plane(random.direction()), along = cross(plane, Vec3d(random.direction())) * 4.0;
  const double swell = random.next() % 3 == 0 ? 0.1 : 0.0;
  const bool shears = random.next() % 4 == 0;
  return [=](const Vec3d& p, double u) {
    const Vec3d moved = drift * (u - 0.5);
    if (inverts) return p * (1.0 - 2.0 * u) + moved;
    if (shears) return p + along * (dot(p, plane) * (u - 0.5)) + moved;
    return turn(p * (1.0 + swell * std::sin(dot(p, waves) + 3.0 * u)), u) + moved;
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
  shell.inverts = form.moving() && random.next() % 8 == 0;
  const double scale = std::exp2(random.uniform(-20.0f, 20.0f));
  const double share = one_of(random, {0.0, 1.0, 1e2, 1e3, 1e4, 1e5});  // 1e5: up to 1e11
  const double distance = (shell.inverts ? std::min(share, 1e2) : share) * scale;
  const Vec3d place = Vec3d(random.direction()) * distance;
  const bool instanced = random.next() % 4 == 0;
  about << "seed " << seed << ": " << form.segments << " segments of degree " << form.degree << ", size "
        << scale << ", distance " << distance << (instanced ? ", instanced" : "")
        << (shell.inverts ? ", turned inside out" : "");
  // 64: what drifts and maps add to the place, in radii. A shear by 4 makes a shell four times as flat.
  shell.face_distance = kRoundingsFromFace * 0x1p-24 * (distance / scale + 64.0) *
                        (shell.inverts ? 1.0 / double(kLeastVolume) : 4.0);
  const Motion motion = random_motion(random, form, shell.inverts);
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

// Where the shell is at a time of the shutter.
class ShellPose {
 public:
  ShellPose(const Shell& shell, float time) : mesh_(*shell.mesh), time_(time) {
    if (!shell.world_from_shell.empty())
      world_ = Affine3d(evaluate(shell.world_from_shell, shell.instance_form, time));
  }
  Vec3d vertex(std::uint32_t i) const { return world_.point(Vec3d(mesh_.position(i, time_))); }
  Vec3d centre() const { return vertex(mesh_.vertex_count - 1); }
  Vec3d inside(Random& random) const {
    const Vec3d c = centre();
    return c + (vertex(random.next() % (mesh_.vertex_count - 1)) - c) * double(kInside * random.uniform());
  }
  const Triangle& triangle(Random& random) const {
    return mesh_.triangles[random.next() % mesh_.triangles.size()];
  }
  Vec3d on_face(const Triangle& t, Random& random) const {
    const double a = random.uniform(), b = random.uniform() * (1.0 - a);
    return vertex(t[0]) * (1.0 - a - b) + vertex(t[1]) * a + vertex(t[2]) * b;
  }

 private:
  const TriangleMesh& mesh_;
  float time_;
  Affine3d world_;  // from the shell
};

// In the plane of a face, just inside, along one of its edges.
void along_face(const Shell& shell, const ShellPose& pose, Random& random, Ray& ray) {
  const Triangle& t = pose.triangle(random);
  const Vec3d place = pose.on_face(t, random);
  const double inwards = std::min(shell.face_distance, 1.0 - double(kInside));
  ray.org = Vec3f(place + (pose.centre() - place) * inwards);
  ray.dir = Vec3f(pose.vertex(t[1]) - pose.vertex(t[0]));
}

// From a face itself, through the inside to what lies opposite.
void from_surface(const ShellPose& pose, Random& random, Ray& ray) {
  ray.org = Vec3f(pose.on_face(pose.triangle(random), random));
  ray.dir = Vec3f(pose.inside(random) - Vec3d(ray.org));
}

// From inside, anywhere or at vertices and edges, where leaks would be; along faces, and from them.
std::vector<Ray> rays_inside(const Shell& shell, std::uint64_t seed) {
  Random random(seed ^ 0x5eedull);
  std::vector<Ray> rays(kRaysOfShell);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray& ray = rays[i];
    ray.time = i % 64 == 0 ? one_of(random, {0.0f, 0.25f, 0.5f, 1.0f}) : random.uniform();
    if (shell.inverts && std::abs(1.0f - 2.0f * ray.time) < kLeastVolume) ray.time = 0.25f;
    const ShellPose pose(shell, ray.time);
    if (i % 8 == 5) {
      along_face(shell, pose, random, ray);
      continue;
    }
    if (i % 8 == 7) {
      from_surface(pose, random, ray);
      continue;
    }
    ray.org = Vec3f(pose.inside(random));
    const Triangle& triangle = pose.triangle(random);
    const double along = i % 4 == 0 ? 0.0 : double(random.uniform());  // 0: at the vertex
    const Vec3d aim = pose.vertex(triangle[0]) * (1.0 - along) + pose.vertex(triangle[1]) * along;
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
    const std::uint64_t wanted = test::soak_count(10'000'000, 1'000'000'000);
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
