// What a ray computes once per tree.

#if defined(MSBVH_RAY_SETUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_RAY_SETUP_INL_H
#undef MSBVH_RAY_SETUP_INL_H
#else
#define MSBVH_RAY_SETUP_INL_H
#endif

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <hwy/highway.h>
#include <limits>
#include <type_traits>

#include "core/bvh/bvh.h"
#include "core/trace/ray.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Time in [0, 1]; anything else, NaN included, is brought there, so that no key outside a track is ever read.
HWY_INLINE float clamped_time(float time) {
  const float u = time > 0.0f ? time : 0.0f;
  return u < 1.0f ? u : 1.0f;
}

// locate() for the tracks of every level at once.
class LevelTimes {
 public:
  LevelTimes() = default;
  LevelTimes(float u, const Bvh& bvh) {
    const hn::CappedTag<float, 8> d;
    const hn::RebindToSigned<decltype(d)> di;
    HWY_ALIGN static constexpr float kSegments[8] = {0, 1, 2, 4, 8, 16, 32, 64};
    HWY_ALIGN static constexpr std::int32_t kLastKey[8] = {0, 0, 1, 3, 7, 15, 31, 63};
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
      const auto scaled = hn::Mul(hn::Set(d, u), hn::Load(d, kSegments + i));
      const auto key = hn::Min(hn::ConvertTo(di, scaled), hn::Load(di, kLastKey + i));
      hn::Store(key, di, key_ + i);
      hn::Store(hn::Sub(scaled, hn::ConvertTo(d, key)), d, weight_ + i);
    }
    if (bvh.max_level >= 8) {
      const SegmentTime last = locate(u, segments_of_level(8));
      key_[8] = static_cast<std::int32_t>(last.key);
      weight_[8] = last.w;
    }
    key_[kSliceLevel] = 0;
    weight_[kSliceLevel] = weight_[bvh.slice_level];
  }
  SegmentTime operator[](std::uint32_t level) const {
    return {static_cast<std::uint32_t>(key_[level]), weight_[level]};
  }

 private:
  static_assert(kLevels == 10);
  HWY_ALIGN std::int32_t key_[16];
  HWY_ALIGN float weight_[16];
};
struct NoTimes {
  SegmentTime operator[](std::uint32_t) const { return {0, 0.0f}; }
};

// What a ray brings into a still tree, and into any other.
struct StillSetup {
#if HWY_TARGET == HWY_AVX3
  // |1 / direction| for the lower sides of 8 boxes, its negative for the upper ones; and for each axis all
  // bits where the direction is negative, so that the upper sides are met first.
  alignas(64) float signed_reciprocal[3][2 * kWidth];
  std::uint16_t backwards[3];
#else
  float reciprocal[3];
  // For each axis the planes of NodeBounds, as floats from its start, that the ray meets first and last.
  std::uint32_t near_plane[3], far_plane[3];
#endif
  float org[3];
  float
      tnear;  // not a number where the ray is no line: no comparison with it holds, nothing is entered or hit
  // Woop's shear: z is the direction's largest axis; x, y wind so that the triangle's orientation is kept.
  struct alignas(16) Axes {
    std::int32_t x, y, z, unused;
  } axes;
  struct alignas(16) Shear {
    float x, y, scale_z, unused;
  } shear;
  static constexpr NoTimes at_level{};

  StillSetup() = default;
  StillSetup(const Ray& ray, const Bvh&)
      : org{ray.org.x, ray.org.y, ray.org.z},
        tnear(is_line(ray) ? ray.tnear : std::numeric_limits<float>::quiet_NaN()) {
    const hn::FixedTag<float, 4> d;
    const hn::FixedTag<std::int32_t, 4> di;
    const auto one = hn::Set(d, 1.0f);
    static_assert(offsetof(Ray, tfar) == offsetof(Ray, dir) + sizeof(Vec3f));
    const auto dir = hn::LoadU(d, &ray.dir.x);  // and tfar, which is not used
    HWY_ALIGN float inverse[4];
    hn::Store(hn::Div(one, dir), d, inverse);
    for (std::uint32_t axis = 0; axis < 3; ++axis) set_axis(axis, inverse[axis]);
    // No branch: directions are what nobody can guess.
    const float ax = std::abs(ray.dir.x), ay = std::abs(ray.dir.y), az = std::abs(ray.dir.z);
    const std::uint32_t z = (az >= ax) & (az >= ay), y = ay >= ax;
    const std::uint32_t largest = 2 * z | ((z ^ 1) & y);
    std::uint8_t negative[8] = {};
    hn::StoreMaskBits(d, hn::Lt(dir, hn::Zero(d)), negative);
    const std::uint32_t flip = negative[0] >> largest & 1u;
    HWY_ALIGN static constexpr std::int32_t kOrder[6][4] = {{1, 2, 0, 0}, {2, 0, 1, 1}, {0, 1, 2, 2},
                                                            {2, 1, 0, 0}, {0, 2, 1, 1}, {1, 0, 2, 2}};
    const auto order = hn::Load(di, kOrder[3 * flip + largest]);
    hn::Store(order, di, &axes.x);
    const auto wound = hn::TableLookupLanes(dir, hn::IndicesFromVec(d, order));
    const auto along = hn::Broadcast<3>(wound);
    hn::Store(hn::Div(hn::IfThenElse(hn::FirstN(d, 2), wound, one), along), d, &shear.x);
  }

 private:
  // A direction that is zero or not a number would meet every box, also those of children that are not there.
  HWY_INLINE static bool is_line(const Ray& ray) {
    const float dir = std::abs(ray.dir.x) + std::abs(ray.dir.y) + std::abs(ray.dir.z);
    const float org = std::abs(ray.org.x) + std::abs(ray.org.y) + std::abs(ray.org.z);
    return (dir > 0.0f) & (dir + org < std::numeric_limits<float>::infinity());
  }

  // A reciprocal is infinite for 0: see node_test-inl.h.
  HWY_INLINE void set_axis(std::uint32_t axis, float inverse) {
    const std::int32_t sign = std::bit_cast<std::int32_t>(inverse) >> 31;  // all bits, or none
#if HWY_TARGET == HWY_AVX3
    const hn::FixedTag<float, kWidth> d;
    const auto length = hn::Set(d, std::abs(inverse));
    hn::Store(length, d, signed_reciprocal[axis]);
    hn::Store(hn::Neg(length), d, signed_reciprocal[axis] + kWidth);
    backwards[axis] = static_cast<std::uint16_t>(sign);
#else
    reciprocal[axis] = inverse;
    const auto upper = static_cast<std::uint32_t>(-sign);
    near_plane[axis] = kWidth * (2 * axis + upper);
    far_plane[axis] = kWidth * (2 * axis + 1 - upper);
#endif
  }
};

struct MovingSetup : StillSetup {
  LevelTimes at_level;

  MovingSetup() = default;
  MovingSetup(const Ray& ray, const Bvh& bvh) : StillSetup(ray, bvh), at_level(clamped_time(ray.time), bvh) {}
};

template <Movement kMovement>
using RaySetup = std::conditional_t<kMovement == Movement::kStill, StillSetup, MovingSetup>;

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
