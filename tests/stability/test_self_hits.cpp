// Rays that leave a surface must not find the triangle that they start on: as the tracer sees it, at any
// time, far from the origin, through instances, at grazing angles.
#include <random>

#include "core/api/accel.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "core/shade/surface_hit.h"
#include "core/trace/tracer.h"
#include "tests/render/pictures.h"

namespace msbvh {
namespace {
using namespace pictures;

class RandomVectors {
 public:
  float number(float size) { return std::uniform_real_distribution<float>(-size, size)(engine_); }
  Vec3f vector(float size) { return {number(size), number(size), number(size)}; }

 private:
  std::mt19937 engine_{5};
};

constexpr float kFar = 1e4f;

// A triangle of any shape: one in four is a needle, one in four lies in a plane of coordinates.
std::vector<Vec3f> corners(RandomVectors& random, const Vec3f& place, int shape) {
  std::vector<Vec3f> out;
  for (int i = 0; i < 3; ++i) out.push_back(place + random.vector(1.0f));
  if (shape == 1) out[1] = out[0] + random.vector(1e-3f);
  if (shape == 2) out[0].z = out[1].z = out[2].z = 0.0f;
  return out;
}

// One moving triangle in a scene and in a tree of its own.
struct Subject {
  Scene scene;
  Accel accel;
  bool singular = false;

  Subject(RandomVectors& random, bool instanced, int shape) {
    const Vec3f place = instanced ? Vec3f{} : random.vector(kFar);
    const Mesh mesh = polygon({corners(random, place, shape), corners(random, place, shape)});
    if (!instanced) {
      add(scene, mesh);
      accel.add_mesh(mesh.shape);
    } else {
      Affine3f first{random.vector(1), random.vector(1), random.vector(1), random.vector(kFar)},
          second = first;
      second.t += random.vector(10.0f);
      singular = std::abs(first.determinant()) < 0.01f;
      add_instance(scene, mesh, {first, second});
      auto object = std::make_shared<Accel>();
      object->add_mesh(mesh.shape);
      object->commit();
      accel.add_instances(object, {1, 1}, scene.instances[0].world_from_prototype);
    }
    accel.commit();
  }
};

// Towards a point on the triangle, from some distance.
Ray aim(const Subject& subject, RandomVectors& random) {
  Ray ray;
  ray.time = std::abs(random.number(1.0f));
  const float v = std::abs(random.number(1.0f)), u = (1.0f - v) * std::abs(random.number(1.0f));
  const HitSource source =
      SceneIndex(subject.scene).resolve({.instance = subject.scene.instances.empty() ? kNoInstance : 0});
  const Hit there{.u = u, .v = v, .triangle = 0};
  ray.dir = random.vector(1.0f);
  ray.org = surface_at(subject.scene, source, there, ray).position - ray.dir * 5.0f;
  return ray;
}

int self_hits(const Subject& subject, RandomVectors& random, int& spawned) {
  const Ray ray = aim(subject, random);
  Hit hit;
  if (!subject.accel.intersect(ray, hit)) return 0;
  const SceneIndex index(subject.scene);
  SurfaceHit point = surface_at(subject.scene, index.resolve(hit), hit, ray);
  if (!clear_origin({index, subject.accel.bvh()}, ray, point.origin)) return 0;
  int hits = 0;
  for (int i = 0; i < 40; ++i) {
    Ray next;
    next.dir = random.vector(1.0f);
    if (i % 2 == 0) next.dir += point.geometric_normal * (-0.999f * dot(next.dir, point.geometric_normal));
    if (dot(next.dir, next.dir) < 1e-6f) continue;
    next = leave(point, next.dir, ray.time);
    hits += subject.accel.occluded(next);
    ++spawned;
  }
  return hits;
}

TEST_CASE("no ray hits the triangle that it leaves") {
  RandomVectors random;
  for (const bool instanced : {false, true}) {
    CAPTURE(instanced);
    int spawned = 0, hits = 0;
    for (int round = 0; round < 5000; ++round) {
      const Subject subject(random, instanced, round % 4);
      if (!subject.singular) hits += self_hits(subject, random, spawned);
    }
    CHECK(spawned > 100000);
    CHECK(hits == 0);
  }
}

}  // namespace
}  // namespace msbvh
