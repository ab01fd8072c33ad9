// Tests of rays against curves and points: vertices at the ray's time, the ray's direction and frame.

#if defined(MSBVH_ROUND_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_ROUND_TEST_INL_H
#undef MSBVH_ROUND_TEST_INL_H
#else
#define MSBVH_ROUND_TEST_INL_H
#endif

#include <cmath>
#include <cstdint>
#include <hwy/highway.h>

#include "core/bvh/bvh.h"
#include "core/trace/ray_setup-inl.h"
#include "core/trace/simd_lerp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D4f = hn::FixedTag<float, 4>;

// x, y, z and radius of a vertex; a normal and 0.
HWY_INLINE hn::Vec<D4f> lanes_of(const RoundVertex& vertex) { return hn::LoadU(D4f(), &vertex.p.x); }
HWY_INLINE hn::Vec<D4f> lanes_of(const Vec3f& normal) {
  alignas(16) const float lanes[4] = {normal.x, normal.y, normal.z, 0.0f};
  return hn::Load(D4f(), lanes);
}

// What a set keeps for each of its vertices, at a ray's time.
template <Movement kMovement, typename Value>
class ValuesAtTime {
 public:
  // `count`: vertices at each control.
  HWY_INLINE ValuesAtTime(const Value* values, std::size_t count, FormCode form,
                          const RaySetup<kMovement>& setup)
      : first_(values), stride_(count), moves_(kMovement != Movement::kStill && form.level() != 0) {
    if (!moves_) return;
    degree_ = kMovement == Movement::kPolynomial ? form.degree() : 1;
    const SegmentTime at = setup.at_level[form.level()];
    first_ += std::size_t(at.key) * degree_ * count;
    w_ = at.w;
  }
  HWY_INLINE hn::Vec<D4f> operator[](std::uint32_t vertex) const {
    const auto control = [&](std::size_t c) { return lanes_of(first_[vertex + c * stride_]); };
    return moves_ ? simd_bezier(control, degree_, Weights<D4f>(D4f(), w_)) : control(0);
  }

 private:
  const Value* first_;
  std::size_t stride_;
  bool moves_;
  std::uint32_t degree_ = 1;
  float w_ = 0.0f;
};
template <Movement kMovement>
using VerticesAtTime = ValuesAtTime<kMovement, RoundVertex>;
template <Movement kMovement>
using NormalsAtTime = ValuesAtTime<kMovement, Vec3f>;

// The dot product of a vector with the one in each lane.
template <class D>
HWY_INLINE hn::Vec<D> dot_lanes(D d, const Vec3f& a, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) {
  return hn::MulAdd(z, hn::Set(d, a.z), hn::MulAdd(y, hn::Set(d, a.y), hn::Mul(x, hn::Set(d, a.x))));
}

// A ray's direction, from what its setup keeps of it: to a rounding or two, 0 where it is 0.
HWY_INLINE Vec3f direction_of(const StillSetup& setup) {
#if HWY_TARGET == HWY_AVX3
  const auto along = [&](int axis) {
    const float d = 1.0f / setup.signed_reciprocal[axis][0];
    return setup.backwards[axis] ? -d : d;
  };
#else
  const auto along = [&](int axis) { return 1.0f / setup.reciprocal[axis]; };
#endif
  return {along(0), along(1), along(2)};
}

// A ray's direction, made as long along its largest axis as 1.
HWY_INLINE Vec3f sheared_direction(const StillSetup& setup) {
  Vec3f d;
  d[setup.axes.x] = setup.shear.x, d[setup.axes.y] = setup.shear.y, d[setup.axes.z] = 1.0f;
  return d;
}

// The ray as an axis: z along it, x and y across; all unit. T. Duff et al., "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), 2017.
struct RayFrame {
  Vec3f x, y, z;
  float inverse_length;  // of the direction: t is z times it

  HWY_INLINE explicit RayFrame(const Vec3f& dir) {
    // Scaled first: squares of what is tiny or huge would be 0 or infinite.
    const float most = std::max(std::max(std::abs(dir.x), std::abs(dir.y)), std::abs(dir.z));
    const Vec3f d = dir * (1.0f / most);
    const float length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    inverse_length = 1.0f / (length * most);
    z = d * (1.0f / length);
    const float sign = std::copysign(1.0f, z.z), a = -1.0f / (sign + z.z), b = z.x * z.y * a;
    x = {1.0f + sign * z.x * z.x * a, sign * b, -sign * z.x};
    y = {b, sign + z.y * z.y * a, -z.y};
  }
  // A vector on the frame's axes.
  HWY_INLINE Vec3f seen(const Vec3f& v) const {
    const auto on = [&](const Vec3f& axis) { return axis.x * v.x + axis.y * v.y + axis.z * v.z; };
    return {on(x), on(y), on(z)};
  }
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
