// What the oracle says of one primitive and one ray (core/trace/oracle.h).
#pragma once

#include <cstdint>
#include <functional>

#include "core/bvh/bvh.h"
#include "core/geometry/geometry_id.h"

namespace msbvh {

struct RayD {
  Vec3d org, dir;
  double error;  // absolute, of a single-precision kernel in this space, without the vertices' share
  double tnear = 0.0, tfar = 0.0;
};

// What was hit, or may be.
struct PrimitiveId {
  std::uint32_t instance;
  GeometryId geometry;
  std::uint32_t triangle;
  bool operator==(const PrimitiveId&) const = default;
};

struct Verdict {
  bool clear = false;     // hit, and farther from every edge than the error
  bool possible = false;  // hit, or missed by less than the error
  bool hit = false;       // in exact arithmetic, edges included
  double t = 0.0, u = 0.0, v = 0.0;
  double t_lo = 0.0, t_hi = 0.0;  // what a kernel may say of t
};

using VerdictVisitor = std::function<void(const PrimitiveId&, const Verdict&)>;

// Of the curves and points of one tree, `u` being the time in it: those that are hit or may be, within
// [tnear, tfar].
void judge_round(const Bvh& bvh, const RayD& ray, double u, std::uint32_t instance,
                 const VerdictVisitor& visit);

}  // namespace msbvh
