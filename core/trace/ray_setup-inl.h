// What a ray computes once per tree.

#if defined(MSBVH_RAY_SETUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_RAY_SETUP_INL_H
#undef MSBVH_RAY_SETUP_INL_H
#else
#define MSBVH_RAY_SETUP_INL_H
#endif

#include <cmath>
#include <hwy/highway.h>
#include <utility>

#include "core/bvh/bvh.h"
#include "core/trace/ray.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

// Time in [0, 1]; anything else, NaN included, is brought there, so that no key outside a track is ever read.
HWY_INLINE float clamped_time(float time) { return std::fmin(std::fmax(time, 0.0f), 1.0f); }

template <Movement kMovement>
struct RaySetup {
  static constexpr bool kMoving = kMovement != Movement::kStill;

  float org[3], reciprocal[3];
  float tnear;
  // For each axis the planes of NodeBounds, as floats from its start, that the ray meets first and last.
  std::uint32_t near_plane[3], far_plane[3];
  // Woop's shear: kz is the direction's largest axis; kx, ky wind so that the triangle's orientation is kept.
  int kx, ky, kz;
  float shear_x, shear_y, scale_z;
  SegmentTime at_level[kMoving ? kLevels : 1];

  RaySetup(const Ray& ray, std::uint32_t max_level) : tnear(ray.tnear) {
    const float dir[3] = {ray.dir.x, ray.dir.y, ray.dir.z};
    for (int axis = 0; axis < 3; ++axis) {
      org[axis] = ray.org[axis];
      reciprocal[axis] = 1.0f / dir[axis];  // infinite for 0: see node_test-inl.h
      const bool backwards = std::signbit(dir[axis]);
      near_plane[axis] = kWidth * static_cast<std::uint32_t>(axis + (backwards ? 3 : 0));
      far_plane[axis] = kWidth * static_cast<std::uint32_t>(axis + (backwards ? 0 : 3));
    }
    const float ax = std::abs(dir[0]), ay = std::abs(dir[1]), az = std::abs(dir[2]);
    kz = az >= ax && az >= ay ? 2 : (ay >= ax ? 1 : 0);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    if (dir[kz] < 0.0f) std::swap(kx, ky);
    shear_x = dir[kx] / dir[kz];
    shear_y = dir[ky] / dir[kz];
    scale_z = 1.0f / dir[kz];
    if constexpr (kMoving) {
      const float u = clamped_time(ray.time);
      for (std::uint32_t level = 0; level <= max_level; ++level)
        at_level[level] = locate(u, segments_of_level(level));
      at_level[kSliceLevel] = {0, at_level[max_level].w};
    }
  }
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
