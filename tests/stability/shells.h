// Closed shells of random triangles, and paths of light inside them that head for their edges and corners.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "core/shade/surface_hit.h"
#include "core/trace/tracer.h"
#include "tests/render/pictures.h"

namespace msbvh::shells {

using procedural::Random;

enum class Solid : std::uint8_t {
  kStar,    // a sphere of triangles whose vertices are at random distances from the centre: acute corners
  kTangle,  // the same with vertices moved sideways too: it crosses itself
  kTetra    // a random tetrahedron: any angle between two faces
};

struct Shell {
  const char* name;
  Solid solid = Solid::kStar;
  int rings = 5;
  TrackForm form{};  // each control has a shape of its own
  float scale = 1.0f;
  float place = 0.0f;  // of the centre, on each axis
  bool instanced = false;
  bool resting = false;  // the instance does not move
};

// The centre lies inside at any time.
inline std::vector<Vec3f> random_pose(const Shell& shell, const std::vector<Vec3f>& sphere, Random& random) {
  std::vector<Vec3f> pose;
  for (const Vec3f& p : sphere) {
    Vec3f q = p * random.uniform(0.3f, 1.0f);
    if (shell.solid == Solid::kTangle) q += random.direction() * 0.25f;
    pose.push_back(q * shell.scale);
  }
  return pose;
}

// Around the origin; its inscribed sphere has a radius of more than 1 / 400.
inline std::vector<Vec3f> tetrahedron(Random& random) {
  for (;;) {
    std::vector<Vec3f> c;
    for (int i = 0; i < 4; ++i) c.push_back(random.direction());
    const Vec3f middle = (c[0] + c[1] + c[2] + c[3]) * 0.25f;
    for (Vec3f& p : c) p = p - middle;
    if (std::abs(dot(c[1] - c[0], cross(c[2] - c[0], c[3] - c[0]))) > 0.02f) return c;
  }
}

inline Mesh shell_mesh(const Shell& shell, Random& random, const Vec3f& place) {
  Mesh mesh;
  mesh.shape = shell.solid == Solid::kTetra ? TriangleMesh{} : procedural::sphere(shell.rings);
  std::vector<Vec3f> base(mesh.shape.positions.begin(),
                          mesh.shape.positions.begin() + mesh.shape.vertex_count);
  if (shell.solid == Solid::kTetra) {
    base = tetrahedron(random);
    mesh.shape.vertex_count = 4;
    mesh.shape.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  }
  mesh.shape.name = "/shell";
  mesh.shape.segments = shell.form.segments;
  mesh.shape.degree = shell.form.degree;
  mesh.shape.positions.clear();
  for (std::uint32_t c = 0; c < shell.form.controls(); ++c) {
    const bool tetra = shell.solid == Solid::kTetra;
    const Vec3f drift = random.direction() * (tetra ? 0.0f : 0.05f * shell.scale);
    for (const Vec3f& p : tetra ? base : random_pose(shell, base, random)) {
      mesh.shape.positions.push_back((tetra ? p * shell.scale : p) + drift + place);
    }
  }
  return mesh;
}

// One shell in a scene, its trees, and what paths in it need.
class Trap {
 public:
  Trap(const Shell& shell, std::uint64_t seed) {
    Random random(seed);
    const Vec3f place{shell.place, -shell.place, shell.place};
    if (!shell.instanced) {
      pictures::add(scene_, shell_mesh(shell, random, place));
      centre_ = Vec3d(place);
    } else {
      const auto axis = [&](Vec3f unit) { return unit + random.direction() * 0.4f; };
      Affine3f open{axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1}), place}, close = open;
      close.x += random.direction() * 0.3f;
      close.t += random.direction() * shell.scale;
      const std::vector<Affine3f> keys{open, close};
      pictures::add_instance(scene_, shell_mesh(shell, random, {}), shell.resting ? std::vector{open} : keys);
    }
    build();
    radius_ = 0.001f * shell.scale;
  }

  const Scene& scene() const { return scene_; }
  const SceneIndex& index() const { return index_; }
  const Accel& accel() const { return accel_; }

  // From about the centre of the shell.
  Ray first_ray(Random& random) const {
    Ray ray;
    ray.time = random.uniform();
    const Vec3d middle = to_world({}, ray.time) + (scene_.instances.empty() ? centre_ : Vec3d{});
    ray.org = Vec3f(middle) + random.direction() * radius_;
    ray.dir = random.direction();
    return ray;
  }

  // A direction from `origin` to a point of the shell next to an edge or a corner.
  Vec3f towards_edge(const Vec3f& origin, float time, Random& random) const {
    const TriangleMesh& shape = scene_.meshes[0].shape;
    const Triangle& t = shape.triangles[random.next() % shape.triangles.size()];
    const auto beside = [&] { return std::pow(10.0, double(random.uniform(-9.0f, -1.0f))); };
    const double b = random.uniform() < 0.3f ? beside() : random.uniform(), c = beside();
    const auto corner = [&](int i) { return Vec3d(shape.position(t[i], time)); };
    const Vec3d p = corner(0) * (1.0 - b - c) + corner(1) * b + corner(2) * c;
    return Vec3f(normalize(to_world(p, time) - Vec3d(origin)));
  }

 private:
  Vec3d to_world(const Vec3d& p, float time) const {
    if (scene_.instances.empty()) return p;
    const std::vector<Affine3f>& keys = scene_.instances[0].world_from_prototype;
    return lerp(Affine3d(keys.front()), Affine3d(keys.back()), double(time)).point(p);
  }

  void build() {
    if (scene_.instances.empty()) {
      accel_.add_mesh(scene_.meshes[0].shape);
    } else {
      const auto object = std::make_shared<Accel>();
      object->add_mesh(scene_.meshes[0].shape);
      object->commit();
      accel_.add_instances(object, scene_.instances[0].form(), scene_.instances[0].world_from_prototype);
    }
    accel_.commit();
    index_ = SceneIndex(scene_);
  }

  Scene scene_;
  Accel accel_;
  SceneIndex index_{scene_};
  Vec3d centre_{};
  float radius_ = 0.0f;
};

}  // namespace msbvh::shells
