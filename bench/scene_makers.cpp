#include "bench/scene_makers.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/limit_mesh.h"
#include "bench/shapes.h"
#include "core/geometry/subdivision/dice.h"

namespace msbvh::bench {

namespace {

Camera camera_at(const Vec3f& eye, const Vec3f& target) {
  const Vec3f z = normalize(eye - target), x = normalize(cross(Vec3f{0, 1, 0}, z)), y = cross(z, x);
  Camera camera;
  camera.name = "camera";
  camera.world_from_camera = {Affine3f{x, y, z, eye}};
  camera.window = {{-0.4f, 0.4f, -0.4f, 0.4f}};
  camera.near_clip = 1e-3f;
  return camera;
}

// Meshes in the world, seen from outside of the ball of radius 1.5 or from `eye`.
BenchScene scene_of(std::vector<TriangleMesh> meshes, const Interior& interior = {},
                    const Vec3f& eye = {2.2f, 1.6f, 3.0f}) {
  auto scene = std::make_shared<Scene>();
  for (TriangleMesh& mesh : meshes) {
    scene->world.push_back(mesh_id(static_cast<std::uint32_t>(scene->meshes.size())));
    scene->meshes.emplace_back().shape = std::move(mesh);
  }
  scene->camera = camera_at(eye, {});
  return {std::move(scene), interior};
}

template <typename... Meshes>
std::vector<TriangleMesh> list(Meshes... meshes) {
  std::vector<TriangleMesh> all;
  (all.push_back(std::move(meshes)), ...);
  return all;
}

}  // namespace

BenchScene hairball(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  Pose pose = strands(triangles, random);
  std::vector<Vec3d> axes;
  for (std::size_t s = 0; s < pose.positions.size() / 12; ++s) axes.push_back(Vec3d(random.direction()));
  const auto motion = [&](std::uint32_t v, const Vec3d& p, double u) {  // swings more towards the tip
    return turned(p, axes[v / 12], 0.25 * (length(p) - 0.4) * (u - 0.5)) + Vec3d{0.1, 0.0, 0.0} * (u - 0.5);
  };
  return scene_of(list(moved_mesh("strands", std::move(pose), form, motion)));
}

BenchScene fences(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  const Vec3d tilt = normalize(Vec3d{0.3, 1.0, 0.2});
  Pose pose;
  const auto place = [&](const Vec3f& p) { return Vec3f(turned(Vec3d(p), tilt, 0.6)); };
  const std::uint32_t bars = std::max(1u, triangles / 6), rows = 40;
  for (std::uint32_t i = 0; i < bars; ++i) {
    const float z = -1.0f + 2.0f * static_cast<float>(i % rows) / rows, x = random.uniform(-1.0f, 1.0f);
    const bool rail = i / rows < 4;
    const float y = rail ? 0.3f * static_cast<float>(i / rows) - 0.45f : -0.7f;
    const Vec3f a = rail ? Vec3f{-1.0f, y, z} : Vec3f{x, y, z},
                b = rail ? Vec3f{1.0f, y, z} : Vec3f{x, 0.7f, z};
    add_bar(pose, place(a), place(b), rail ? 0.004f : 0.3f / static_cast<float>(bars / rows + 8));
  }
  const auto motion = [](std::uint32_t, const Vec3d& p, double u) {  // as if the camera panned and flew
    return turned(p, {0.0, 1.0, 0.0}, 0.1 * (u - 0.5)) + Vec3d{0.15, 0.05, 0.0} * (u - 0.5);
  };
  return scene_of(list(moved_mesh("fences", std::move(pose), form, motion)));
}

BenchScene spinning_wheels(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  std::vector<Wheel> placed;
  Pose pose = wheels(triangles, random, placed);
  const auto motion = [&](std::uint32_t v, const Vec3d& p, double u) {
    const Wheel& wheel = placed[v / kWheelVertices];
    return wheel.hub + turned(p - wheel.hub, wheel.axis, 1.5 * (u - 0.5)) + Vec3d{0.1, 0.0, 0.0} * (u - 0.5);
  };
  return scene_of(list(moved_mesh("wheels", std::move(pose), form, motion)));
}

BenchScene twist(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  const auto motion = [](std::uint32_t, const Vec3d& p, double u) {
    return turned(p, {0.0, 1.0, 0.0}, 0.8 * p.y * (u - 0.5)) + Vec3d{0.05, 0.0, 0.0} * (u - 0.5);
  };
  return scene_of(list(moved_mesh("scan", bumpy_sphere(triangles, 0.15f, random), form, motion)),
                  {{0, 0, 0}, 0.3f});
}

BenchScene subdiv(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  return scene_of(list(limit_mesh(torus_cage(form, random), triangles)));
}

BenchScene cloth(std::uint32_t triangles, const TrackForm& form, std::uint32_t) {
  const int side = std::max(4, static_cast<int>(std::sqrt(static_cast<double>(triangles) / 6.0)));
  std::vector<TriangleMesh> layers;
  for (int i = 0; i < 3; ++i) {
    TriangleMesh sheet = procedural::grid(side);
    sheet.positions.resize(sheet.vertex_count);
    for (Vec3f& p : sheet.positions) p = p * 0.5f;
    const auto wave = procedural::wave(0.08, 0.5 + 0.2 * i);
    const auto motion = [&](std::uint32_t, const Vec3d& p, double u) {
      return wave(p, 0.25 * u) + Vec3d{0.0, 0.3 * (i - 1), 0.0};
    };
    layers.push_back(
        moved_mesh("sheet", {std::move(sheet.positions), std::move(sheet.triangles)}, form, motion));
  }
  return scene_of(std::move(layers));
}

namespace {

struct Flight {
  Vec3d velocity, axis, center;
  double turn;
};

std::vector<Flight> flights(const Pose& pose, Random& random) {
  std::vector<Flight> all;
  for (std::size_t s = 0; s < pose.positions.size() / 4; ++s) {
    const Vec3d center = (Vec3d(pose.positions[4 * s]) + Vec3d(pose.positions[4 * s + 1]) +
                          Vec3d(pose.positions[4 * s + 2]) + Vec3d(pose.positions[4 * s + 3])) *
                         0.25;
    all.push_back({Vec3d(random.direction() * random.uniform(0.0f, 0.4f)), Vec3d(random.direction()), center,
                   double(random.uniform(0.0f, 2.0f))});
  }
  return all;
}

}  // namespace

BenchScene debris(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  Pose pose = shards(triangles, random);
  const std::vector<Flight> all = flights(pose, random);
  const auto motion = [&](std::uint32_t v, const Vec3d& p, double u) {
    const Flight& f = all[v / 4];
    return f.center + turned(p - f.center, f.axis, f.turn * (u - 0.5)) + f.velocity * (u - 0.5);
  };
  return scene_of(list(moved_mesh("debris", std::move(pose), form, motion)));
}

BenchScene ballistic(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  Pose pose = shards(triangles, random);
  const std::vector<Flight> all = flights(pose, random);
  const auto motion = [&](std::uint32_t v, const Vec3d& p, double u) {
    const double t = u - 0.5;
    return p + all[v / 4].velocity * t + Vec3d{0.0, -0.8, 0.0} * (t * t);
  };
  return scene_of(list(moved_mesh("ballistic", std::move(pose), form, motion)));
}

BenchScene room(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  const auto rest = [](std::uint32_t, const Vec3d& p, double) { return p; };
  Pose things;
  for (std::uint32_t i = 0; i < triangles / 60; ++i) {
    const Vec3f foot{random.uniform(-0.9f, 0.9f), -0.95f, random.uniform(-0.9f, 0.9f)};
    add_bar(things, foot, foot + Vec3f{0.0f, random.uniform(0.05f, 0.4f), 0.0f}, 0.002f);
  }
  Pose statue = bumpy_sphere(triangles / 2, 0.2f, random), ball = bumpy_sphere(triangles / 20, 0.1f, random);
  for (Vec3f& p : statue.positions) p = p * 0.25f + Vec3f{-0.4f, -0.5f, -0.3f};
  for (Vec3f& p : ball.positions) p = p * 0.08f;
  const auto throw_ball = [](std::uint32_t, const Vec3d& p, double u) {
    return turned(p, {0.0, 0.0, 1.0}, 4.0 * (u - 0.5)) + Vec3d{1.2, 0.6, 0.4} * (u - 0.5) +
           Vec3d{0.1, 0.2, 0.2};
  };
  return scene_of(list(moved_mesh("walls", cube_shell(triangles / 3, 1.0f), TrackForm{0, 1}, rest),
                       moved_mesh("things", std::move(things), TrackForm{0, 1}, rest),
                       moved_mesh("statue", std::move(statue), TrackForm{0, 1}, rest),
                       moved_mesh("ball", std::move(ball), form, throw_ball)),
                  {{0.6f, 0.6f, 0.6f}, 0.2f}, {0.8f, 0.5f, 0.85f});
}

BenchScene crowd(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  constexpr std::uint32_t kKinds = 4, kInstances = 125;
  Random random(seed);
  auto scene = std::make_shared<Scene>();
  for (std::uint32_t kind = 0; kind < kKinds; ++kind) {
    const auto walk = [&](std::uint32_t, const Vec3d& p, double u) {
      return turned(p, {1.0, 0.0, 0.0}, 0.4 * p.y * (u - 0.5));
    };
    TriangleMesh body = moved_mesh("body", bumpy_sphere(triangles / kKinds, 0.25f, random), form, walk);
    scene->meshes.emplace_back().shape = std::move(body);
    scene->prototypes.push_back({.name = "kind", .geometry = {mesh_id(kind)}});
    InstanceSet set{.name = "people",
                    .prototype = kind,
                    .segments = form.segments,
                    .world_from_prototype = {},
                    .display_color = {}};
    for (std::uint32_t i = 0; i < kInstances; ++i) {
      const Vec3d at(random.in_box({-1, -0.1f, -1}, {1, 0.1f, 1})), travel(random.direction() * 0.1f);
      const double start = 6.0 * random.uniform();
      for (std::uint32_t k = 0; k < key_count(form.segments); ++k) {
        const double u = form.moving() ? double(k) / form.segments - 0.5 : 0.0;
        const auto column = [&](const Vec3d& v) {
          return Vec3f(turned(v, {0, 1, 0}, start + 0.6 * u) * 0.05);
        };
        set.world_from_prototype.push_back(
            {column({1, 0, 0}), column({0, 1.8, 0}), column({0, 0, 1}), Vec3f(at + travel * u)});
      }
    }
    scene->instances.push_back(std::move(set));
  }
  scene->camera = camera_at({1.4f, 1.0f, 1.9f}, {});
  return {std::move(scene), {}};
}

namespace {

// A bar wound about the y axis, from -1 to 1.
Pose coil(std::uint32_t triangles) {
  Pose pose;
  const std::uint32_t bars = std::max(8u, triangles / 6);
  const auto at = [&](std::uint32_t i) {
    const float along = static_cast<float>(i) / static_cast<float>(bars);
    return Vec3f(turned({0.06, 2.0 * along - 1.0, 0.0}, {0.0, 1.0, 0.0}, 60.0 * along));
  };
  for (std::uint32_t i = 0; i < bars; ++i) add_bar(pose, at(i), at(i + 1), 0.02f);
  return pose;
}

}  // namespace

BenchScene rods(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  constexpr std::uint32_t kInstances = 500;
  Random random(seed);
  auto scene = std::make_shared<Scene>();
  const auto sway = [](std::uint32_t, const Vec3d& p, double u) {
    return turned(p, {1.0, 0.0, 0.0}, 0.1 * p.y * (u - 0.5));
  };
  scene->meshes.emplace_back().shape = moved_mesh("coil", coil(triangles), form, sway);
  scene->prototypes.push_back({.name = "rod", .geometry = {mesh_id(0)}});
  InstanceSet set{.name = "rods", .segments = form.segments, .world_from_prototype = {}, .display_color = {}};
  for (std::uint32_t i = 0; i < kInstances; ++i) {
    const Vec3d at(random.in_box({-1, -1, -1}, {1, 1, 1})), y(random.direction());
    const Vec3d axis = normalize(cross(y, Vec3d(random.direction()))), z = cross(axis, y);
    for (std::uint32_t k = 0; k < key_count(form.segments); ++k) {
      const double turn = form.moving() ? 0.3 * (double(k) / form.segments - 0.5) : 0.0;
      const auto column = [&](const Vec3d& v) { return Vec3f(turned(v, axis, turn) * 0.5); };
      set.world_from_prototype.push_back({column(axis), column(y), column(z), Vec3f(at)});
    }
  }
  scene->instances.push_back(std::move(set));
  scene->camera = camera_at({2.2f, 1.6f, 3.0f}, {});
  return {std::move(scene), {}};
}

namespace {

// Bumps as fine as a fortieth of the torus, finer than its cage by far.
double bump(const SurfacePoint& at) {
  const Vec3d p = at.position * 30.0;
  return 0.02 * std::sin(p.x) * std::cos(p.y) * std::sin(p.z + 0.7);
}

}  // namespace

BenchScene displaced(std::uint32_t triangles, const TrackForm& form, std::uint32_t seed) {
  constexpr double kFaces = 240.0;
  Random random(seed);
  const double level = 0.5 * std::log2(static_cast<double>(triangles) / (2.0 * kFaces));
  DiceSettings settings;
  settings.level = static_cast<std::uint32_t>(std::clamp(std::round(level), 1.0, 9.0));
  settings.displacement = bump;
  auto scene = std::make_shared<Scene>();
  scene->grids.emplace_back().shape = dice(torus_cage(form, random), settings);
  scene->world = {grids_id(0)};
  scene->camera = camera_at({2.2f, 1.6f, 3.0f}, {});
  return {std::move(scene), {}};
}

namespace {

BenchScene scene_of(Curves curves, const Vec3f& eye) {
  auto scene = std::make_shared<Scene>();
  scene->curves.push_back(std::move(curves));
  scene->world = {curves_id(0)};
  scene->camera = camera_at(eye, {});
  return {std::move(scene), {}};
}

}  // namespace

BenchScene hair(std::uint32_t spans, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  Curves curves;
  curves.shape = hairs(std::max(1u, spans / 8), 8, 0.002f, form, random);
  return scene_of(std::move(curves), {1.5f, 1.1f, 2.0f});
}

BenchScene grass(std::uint32_t spans, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  Curves curves;
  curves.shape = blades(std::max(1u, spans / 2), form, random);
  return scene_of(std::move(curves), {1.3f, 0.5f, 1.3f});
}

BenchScene particles(std::uint32_t count, const TrackForm& form, std::uint32_t seed) {
  Random random(seed);
  auto scene = std::make_shared<Scene>();
  scene->points.emplace_back().shape = balls(count, form, random);
  scene->world = {points_id(0)};
  scene->camera = camera_at({2.2f, 1.6f, 3.0f}, {});
  return {std::move(scene), {}};
}

}  // namespace msbvh::bench
