#include "core/bvh/key_bounds.h"

#include <array>

#include "core/build/clip.h"

namespace msbvh {
namespace {

float largest_coordinate(const Box3f& b) {
  const Vec3f m = max(abs(b.lo), abs(b.hi));
  return std::max({m.x, m.y, m.z});
}

Box3f padded(const Box3f& b, float pad) {
  const Vec3f p{pad, pad, pad};
  return {b.lo - p, b.hi + p};
}

// Corners of the fragment as weights of the triangle's vertices, and its boxes at the mesh's own keys.
class MovingFragment {
 public:
  MovingFragment(const Primitives& primitives, const Reference& reference)
      : mesh_(*primitives.meshes[reference.mesh()]),
        triangle_(mesh_.triangles[reference.index]),
        polygon_(clip_to_box(centre_triangle<double>(primitives, reference), reference.box)) {}

  Box3f at_key(std::uint32_t key) const {
    const std::array<Vec3d, 3> v = vertices(key);
    if (polygon_.count == 0) return whole(v);
    Box3d box;
    for (int i = 0; i < polygon_.count; ++i) {
      const Vec3d& b = polygon_.corners[i];
      box.grow(v[0] * b.x + v[1] * b.y + v[2] * b.z);
    }
    const Box3f rounded = round_outwards(box);
    // The vertices in flight err by their own size, which may be larger at the neighbouring keys.
    const std::uint32_t before = key == 0 ? 0 : key - 1, after = std::min(key + 1, mesh_.segments);
    const float size = std::max({largest_coordinate(whole(vertices(before))), largest_coordinate(whole(v)),
                                 largest_coordinate(whole(vertices(after)))});
    return padded(rounded, kFragmentPad * size);
  }

 private:
  std::array<Vec3d, 3> vertices(std::uint32_t key) const {
    const Vec3f* p = mesh_.key_positions(key);
    return {Vec3d(p[triangle_[0]]), Vec3d(p[triangle_[1]]), Vec3d(p[triangle_[2]])};
  }
  static Box3f whole(const std::array<Vec3d, 3>& v) {
    Box3f box;
    for (const Vec3d& p : v) box.grow(Vec3f(p));  // exact: these were floats
    return box;
  }

  const TriangleMesh& mesh_;
  const Triangle& triangle_;
  BarycentricPolygon polygon_;
};

Box3f triangle_box(const TriangleMesh& mesh, const Triangle& triangle, std::uint32_t key) {
  const Vec3f* p = mesh.key_positions(key);
  Box3f box;
  for (const std::uint32_t v : triangle) box.grow(p[v]);
  return box;
}

void grow_by_triangle(std::span<Box3f> out, std::uint32_t segments, const Primitives& primitives,
                      const Reference& reference) {
  const TriangleMesh& mesh = *primitives.meshes[reference.mesh()];
  std::array<Box3f, kMaxSegments + 1> keys;
  if (reference.is_clipped()) {
    const MovingFragment fragment(primitives, reference);
    for (std::uint32_t k = 0; k <= mesh.segments; ++k) keys[k] = fragment.at_key(k);
  } else {
    const Triangle& triangle = mesh.triangles[reference.index];
    for (std::uint32_t k = 0; k <= mesh.segments; ++k) keys[k] = triangle_box(mesh, triangle, k);
  }
  grow_keys(out, segments, {keys.data(), mesh.segments + 1}, mesh.segments);
}

}  // namespace

void grow_keys(std::span<Box3f> out, std::uint32_t segments, std::span<const Box3f> track,
               std::uint32_t track_segments) {
  if (track_segments == segments) {
    for (std::uint32_t k = 0; k <= segments; ++k) out[k].grow(track[k]);
    return;
  }
  if (track_segments == 0) {
    // (1 - w) x + w x may round below x: the weights need not sum to 1 in floating point.
    const Box3f box = padded(track[0], kRekeyPad * largest_coordinate(track[0]));
    for (std::uint32_t k = 0; k <= segments; ++k) out[k].grow(box);
    return;
  }
  const std::uint32_t ratio = segments / track_segments;
  for (std::uint32_t k = 0; k <= segments; ++k) {
    const std::uint32_t i = std::min(k / ratio, track_segments - 1);
    const float w = static_cast<float>(k - i * ratio) / static_cast<float>(ratio);
    const float size = std::max(largest_coordinate(track[i]), largest_coordinate(track[i + 1]));
    // A fine key on a coarse key bounds the segments on both of its sides.
    const float before = (k % ratio == 0 && i > 0) ? largest_coordinate(track[i - 1]) : 0.0f;
    out[k].grow(padded(lerp(track[i], track[i + 1], w), kRekeyPad * std::max(size, before)));
  }
}

void grow_by_reference(std::span<Box3f> out, std::uint32_t segments, const Primitives& primitives,
                       const Reference& reference) {
  if (!reference.is_instance()) return grow_by_triangle(out, segments, primitives, reference);
  const InstanceBounds& bounds = primitives.instances[reference.index];
  grow_keys(out, segments, bounds.keys, bounds.segments);
}

double mean_half_area(std::span<const Box3f> keys) {
  const auto area = [](const Box3f& b) { return half_area(Box3d{Vec3d(b.lo), Vec3d(b.hi)}); };
  if (keys.size() == 1) return area(keys[0]);
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
    sum += area(keys[k]) + 4.0 * area(lerp(keys[k], keys[k + 1], 0.5f)) + area(keys[k + 1]);
  }
  return sum / (6.0 * static_cast<double>(keys.size() - 1));
}

}  // namespace msbvh
