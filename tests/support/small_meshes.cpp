#include "tests/support/small_meshes.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/procedural.h"

namespace msbvh::procedural {
namespace {

TriangleMesh box() {
  TriangleMesh mesh;
  mesh.vertex_count = 8;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

TriangleMesh small_shape(Random& random) {
  TriangleMesh mesh = random.uniform() < 0.75f ? box() : sphere(3 + static_cast<int>(random.next() % 3));
  const float size = random.uniform(0.05f, 0.15f);
  for (Vec3f& p : mesh.positions) p = p * size;
  return mesh;
}

// Where a mesh is at each time, and when it is there.
struct Flight {
  Vec3f place, drift;
  Motion spin;
  TrackForm form;
  TimeRemap time_remap;

  Vec3f at(double u) const { return place + drift * static_cast<float>(u - 0.5); }
};

Flight random_flight(const SmallMeshes& kind, float side, Random& random) {
  Flight flight;
  flight.place = random.in_box({-side, -side, -side}, {side, side, side});
  flight.drift = random.direction() * random.uniform();
  flight.spin = rotation(Vec3d(random.direction()), random.uniform(0.0f, 2.0f));
  flight.form = kind.form;
  const std::uint32_t segments = 1u << random.next() % 5;
  if (kind.mixed_segments) flight.form.segments = segments;
  const float breakpoint = random.uniform(0.1f, 0.9f);
  if (kind.time_remap) flight.time_remap.pieces = {{0.0f, 0.0f, 0.5f, true}, {breakpoint, 0.5f, 1.0f, true}};
  return flight;
}

void add_points(TriangleMesh shape, const Flight& flight, Scene& scene) {
  const Motion motion = [&](const Vec3d& p, double u) { return flight.spin(p, u) + Vec3d(flight.at(u)); };
  const auto mesh = static_cast<std::uint32_t>(scene.meshes.size());
  const std::string name = "mesh" + std::to_string(mesh);
  scene.meshes.emplace_back();
  scene.meshes.back().shape = validated(moved(std::move(shape), flight.form, motion));
  scene.meshes.back().shape.name = name;
  if (flight.time_remap.is_shutter()) return scene.world.push_back(mesh_id(mesh));
  const auto prototype = static_cast<std::uint32_t>(scene.prototypes.size());
  scene.prototypes.push_back({name, {mesh_id(mesh)}, flight.time_remap});
  scene.instances.push_back({name, prototype, 0, {Affine3f{}}, {}});
}

// A transform's elements are on a track of their own; of curves this one takes the chord.
void add_rigid(TriangleMesh shape, const Flight& flight, Scene& scene) {
  const auto mesh = static_cast<std::uint32_t>(scene.meshes.size());
  const auto prototype = static_cast<std::uint32_t>(scene.prototypes.size());
  shape.name = "mesh" + std::to_string(mesh);
  scene.prototypes.push_back({shape.name, {mesh_id(mesh)}});
  InstanceSet set{shape.name, prototype, flight.form.segments, {}, {}, flight.form.degree, flight.time_remap};
  scene.meshes.emplace_back();
  scene.meshes.back().shape = validated(std::move(shape));
  for (std::uint32_t c = 0; c < flight.form.controls(); ++c) {
    const double u = static_cast<double>(c) / (flight.form.controls() - 1);
    const auto column = [&](const Vec3d& axis) { return Vec3f(flight.spin(axis, u)); };
    set.world_from_prototype.push_back(
        {column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1}), flight.at(u)});
  }
  scene.instances.push_back(std::move(set));
}

}  // namespace

std::shared_ptr<const Scene> small_meshes(const SmallMeshes& kind, std::uint32_t count, std::uint64_t seed) {
  auto scene = std::make_shared<Scene>();
  Random random(seed);
  const float side = std::cbrt(static_cast<float>(count));
  for (std::uint32_t i = 0; i < count; ++i) {
    TriangleMesh shape = small_shape(random);
    Flight flight = random_flight(kind, side, random);
    if (kind.motion == SmallMotion::kStill) flight.form = {0, 1};
    kind.motion == SmallMotion::kRigid ? add_rigid(std::move(shape), flight, *scene)
                                       : add_points(std::move(shape), flight, *scene);
  }
  scene->camera.world_from_camera = {Affine3f{}};
  scene->camera.window = {ScreenWindow{}};
  return scene;
}

}  // namespace msbvh::procedural
