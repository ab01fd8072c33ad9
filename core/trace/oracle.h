// The truth that every kernel is held against: each primitive tested, one by one, in double precision.
//
// A single-precision tracer cannot decide what happens within rounding error of an edge, nor order two hits
// closer than that. So the oracle does not return one hit but says of a given answer whether it is right: the
// triangle that was hit must not be missed by more than the stated error, its distance must agree, and
// nothing that is hit clearly may lie clearly in front of it.
#pragma once

#include <optional>
#include <string>

#include "core/bvh/bvh.h"
#include "core/trace/ray.h"

namespace msbvh {

// Positions and distances are compared to within this share of the largest coordinate involved (ray origin,
// controls that vertices are interpolated from, transformed and not). 2^-24 is one rounding; the kernel
// rounds the interpolated vertex (3), the difference to the origin (1), the sheared coordinate (3) and the
// distance (about 8), and the instance transform (3).
inline constexpr double kOracleError = 0x1p-19;

// Empty if the answer is right, else what is wrong with it, for a person to read. `hit` is the kernel's
// closest hit, none for a miss. Takes time proportional to the number of triangles.
std::optional<std::string> judge_intersection(const Bvh& bvh, const Ray& ray, const std::optional<Hit>& hit);

// The same for an answer of which only the distance is known: that something lies there, and nothing clearly
// before it. Infinity: nothing was hit. Another tracer than ours may be held to it.
std::optional<std::string> judge_distance(const Bvh& bvh, const Ray& ray, float t);

// The same for an any-hit query.
std::optional<std::string> judge_occlusion(const Bvh& bvh, const Ray& ray, bool occluded);

// About how many tests of a triangle the oracle takes for one ray; a span of a curve counts as a thousand.
double oracle_tests_per_ray(const Bvh& bvh);

}  // namespace msbvh
