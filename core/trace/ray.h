// Rays and hits: what goes into traversal and what comes out.
#pragma once

#include <cstdint>
#include <limits>

#include "core/base/vec.h"
#include "core/geometry/geometry_id.h"

namespace msbvh {

struct Ray {
  Vec3f org;
  float tnear = 0.0f;  // hits lie in [tnear, tfar]
  Vec3f dir;           // t is measured in units of it; zero or not finite: the ray hits nothing
  float tfar = std::numeric_limits<float>::infinity();
  float time = 0.0f;  // u in [0, 1] over the shutter
};

inline constexpr std::uint32_t kNoInstance = 0xffffffffu;

// Where a ray of many has hit nothing, its Hit is as constructed: found() is false.
inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

struct Hit {
  float t = 0.0f;
  // Barycentrics of the triangle's second and third vertex. Of a curve: along the span in [0, 1], and across
  // it in [-1, 1], for a tube 0. Of a point: 0.
  float u = 0.0f, v = 0.0f;
  // Index in its mesh or, two a quad, in its mesh of grids; of a curve the span, of a point the point.
  std::uint32_t triangle = kNoTriangle;
  GeometryId geometry{};                 // in the Accel that holds it
  std::uint32_t instance = kNoInstance;  // id in the outer Accel, kNoInstance for a mesh in it directly

  bool found() const { return triangle != kNoTriangle; }
  bool operator==(const Hit&) const = default;
};

}  // namespace msbvh
