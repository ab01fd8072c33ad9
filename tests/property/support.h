// Shared by the property tests: accels of one mesh, and rays held against the oracle.
#pragma once

#include <doctest/doctest.h>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bench/procedural.h"
#include "core/api/accel.h"
#include "core/bvh/bvh.h"
#include "core/bvh/statistics.h"
#include "core/trace/oracle.h"
#include "core/trace/tracer.h"

namespace msbvh::property {

inline Accel accel_of(std::vector<TriangleMesh> meshes, const BuildSettings& settings) {
  Accel accel;
  for (TriangleMesh& m : meshes) accel.add_mesh(std::move(m));
  accel.commit(settings);
  return accel;
}
inline Accel accel_of(std::vector<TriangleMesh> meshes, Builder builder = Builder::kMsbvh) {
  BuildSettings settings;
  settings.builder = builder;
  return accel_of(std::move(meshes), settings);
}

// As many rays in bundles of 32 that look about the same way from about the same place, at times of their
// own; every other bundle has a ray that runs in a plane of two axes.
inline std::vector<Ray> bundles_of(const std::vector<Ray>& rays) {
  constexpr std::size_t kBundle = 32;
  constexpr float kAside = 0.02f;
  std::vector<Ray> bundles = rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& first = rays[i / kBundle * kBundle];
    Ray& ray = bundles[i];
    ray.org = first.org + (rays[i].org - first.org) * kAside;
    ray.dir = first.dir + rays[i].dir * (kAside * length(first.dir) / length(rays[i].dir));
    if (i % (2 * kBundle) == 5) ray.dir.y = 0.0f;
  }
  return bundles;
}

// Many rays at once have the very hits that they have one by one.
inline void check_as_one_by_one(const Tracer& tracer, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  const auto occluded = std::make_unique<bool[]>(rays.size());
  tracer.intersect(rays, hits.data());
  tracer.occluded(rays, occluded.get());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    CAPTURE(i);
    Hit hit;
    CHECK(tracer.intersect(rays[i], hit) == hits[i].found());
    CHECK(hit == hits[i]);
    CHECK(tracer.occluded(rays[i]) == occluded[i]);
  }
}
inline void check_many(const Tracer& tracer, const std::vector<Ray>& rays) {
  check_as_one_by_one(tracer, rays);
  check_as_one_by_one(tracer, bundles_of(rays));
}

// Each ray on each instruction set, closest and any hit, against the double-precision brute force.
inline void check_against_oracle(const Accel& accel, const Vec3f& centre, float radius, int rays,
                                 std::uint64_t seed) {
  std::vector<Ray> all;
  procedural::Random random(seed);
  for (int i = 0; i < rays; ++i) all.push_back(procedural::random_ray(random, centre, radius));
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(instruction_set_name(set));
    const Tracer tracer(accel.bvh(), set);
    int hits = 0;
    for (int i = 0; i < rays; ++i) {
      const Ray& ray = all[static_cast<std::size_t>(i)];
      Hit hit;
      const bool found = tracer.intersect(ray, hit);
      hits += found;
      CAPTURE(i);
      const auto wrong = judge_intersection(accel.bvh(), ray, found ? std::optional(hit) : std::nullopt);
      CHECK_MESSAGE(!wrong, wrong.value_or(""));
      const auto wrong_shadow = judge_occlusion(accel.bvh(), ray, tracer.occluded(ray));
      CHECK_MESSAGE(!wrong_shadow, wrong_shadow.value_or(""));
    }
    CHECK(hits > rays / 50);  // the rays do test something
    check_many(tracer, all);
  }
}

}  // namespace msbvh::property
