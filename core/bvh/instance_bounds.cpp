#include "core/bvh/instance_bounds.h"

#include "core/base/lerp.h"
#include "core/build/clip.h"
#include "core/motion/track.h"

namespace msbvh {
namespace {

template <typename T>
T at_fine_key(std::span<const T> keys, std::uint32_t segments, std::uint32_t key,
              std::uint32_t fine_segments) {
  if (segments == 0) return keys[0];
  const std::uint32_t ratio = fine_segments / segments;
  const std::uint32_t i = std::min(key / ratio, segments - 1);
  return lerp(keys[i], keys[i + 1], static_cast<double>(key - i * ratio) / ratio);
}

Vec3d corner(const Box3d& b, int i) {
  return {(i & 1) ? b.hi.x : b.lo.x, (i & 2) ? b.hi.y : b.lo.y, (i & 4) ? b.hi.z : b.lo.z};
}

Vec3d error_of(const Affine3d& m, const Box3d& b) {
  const Vec3d x = max(abs(b.lo), abs(b.hi));
  return (abs(m.x) * x.x + abs(m.y) * x.y + abs(m.z) * x.z + abs(m.t)) * kInstancePad;
}

struct Pose {
  Affine3d matrix;
  Box3d box;
};

// Adds to both ends of a segment what the quadratic paths of the corners swell beyond their chords. With
// control points b0, b1, b2 a path leaves its chord by 2 u (1 - u) (b1 - (b0 + b2) / 2), at most half of that
// difference.
void grow_segment(const Pose& a, const Pose& b, Box3d& at_a, Box3d& at_b) {
  for (int i = 0; i < 8; ++i) {
    const Vec3d x0 = corner(a.box, i), x1 = corner(b.box, i);
    const Vec3d b0 = a.matrix.point(x0), b2 = b.matrix.point(x1);
    const Vec3d b1 = (a.matrix.point(x1) + b.matrix.point(x0)) * 0.5;
    const Vec3d swell = (b1 - (b0 + b2) * 0.5) * 0.5;
    for (const Vec3d& s : {Vec3d{}, swell}) {
      at_a.grow(b0 + s);
      at_b.grow(b2 + s);
    }
  }
}

}  // namespace

InstanceBounds bound_instance(std::span<const Affine3f> matrix_keys, std::uint32_t matrix_segments,
                              std::span<const Box3f> object_keys, std::uint32_t object_segments) {
  InstanceBounds out;
  out.segments = std::max(matrix_segments, object_segments);
  out.keys.resize(key_count(out.segments));
  if (object_keys.empty() || object_keys[0].empty()) return out;

  std::vector<Affine3d> matrices(matrix_keys.begin(), matrix_keys.end());
  std::vector<Box3d> boxes;
  for (const Box3f& b : object_keys) boxes.push_back({Vec3d(b.lo), Vec3d(b.hi)});
  std::vector<Pose> poses;
  for (std::uint32_t k = 0; k <= out.segments; ++k) {
    poses.push_back({at_fine_key<Affine3d>(matrices, matrix_segments, k, out.segments),
                     at_fine_key<Box3d>(boxes, object_segments, k, out.segments)});
  }
  std::vector<Box3d> bounds(poses.size());
  if (out.segments == 0) grow_segment(poses[0], poses[0], bounds[0], bounds[0]);
  for (std::uint32_t k = 0; k < out.segments; ++k)
    grow_segment(poses[k], poses[k + 1], bounds[k], bounds[k + 1]);
  for (std::uint32_t k = 0; k <= out.segments; ++k) {
    Vec3d pad = error_of(poses[k].matrix, poses[k].box);
    if (k > 0) pad = max(pad, error_of(poses[k - 1].matrix, poses[k - 1].box));
    if (k < out.segments) pad = max(pad, error_of(poses[k + 1].matrix, poses[k + 1].box));
    out.keys[k] = round_outwards({bounds[k].lo - pad, bounds[k].hi + pad});
  }
  return out;
}

}  // namespace msbvh
