// Shared by the property tests: accels of one mesh, and rays held against the oracle.
#pragma once

#include <doctest/doctest.h>
#include <optional>
#include <utility>
#include <vector>

#include "core/api/accel.h"
#include "core/trace/oracle.h"
#include "tests/support/procedural.h"

namespace msbvh::property {

inline Accel accel_of(std::vector<TriangleMesh> meshes, Builder builder = Builder::kMsbvh) {
  Accel accel;
  for (TriangleMesh& m : meshes) accel.add_mesh(std::move(m));
  BuildSettings settings;
  settings.builder = builder;
  accel.commit(settings);
  return accel;
}

// Each ray on each instruction set, closest and any hit, against the double-precision brute force.
inline void check_against_oracle(const Accel& accel, const Vec3f& centre, float radius, int rays,
                                 std::uint64_t seed) {
  for (const InstructionSet set : supported_instruction_sets()) {
    CAPTURE(instruction_set_name(set));
    const Tracer tracer(accel.bvh(), set);
    procedural::Random random(seed);
    int hits = 0;
    for (int i = 0; i < rays; ++i) {
      const Ray ray = procedural::random_ray(random, centre, radius);
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
  }
}

}  // namespace msbvh::property
